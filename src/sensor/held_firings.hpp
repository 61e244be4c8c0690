// Firings whose azimuths a driver did not interpolate. Packets give an azimuth only once for many
// beams that fire one after the other; drivers add to each beam's what the sensor turned meanwhile,
// but not at a packet's end, where the next azimuth is not yet known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sensor/beam_columns.hpp"

namespace sweepcast {

/// Ticks by which interpolated azimuths are off, as the distance of firings varies.
inline constexpr int kInterpolationJitter = 2;

/// A tick brought to [0, turn).
[[nodiscard]] inline std::size_t wrapped_tick(std::int32_t tick, int turn) {
  tick %= turn;
  return static_cast<std::size_t>(tick < 0 ? tick + turn : tick);
}

/// The commonest number of ticks from one firing to the next, 0 where there are fewer than two.
/// `firing`: per tick, whether it is one.
[[nodiscard]] std::int32_t usual_step(std::span<const std::uint8_t> firing);

/// Tells which firings were held, and moves their points there; keeps its buffers.
class HeldFirings {
 public:
  /// `places` as located with whole lags. `interpolated`: that part of each beam's lag that held
  /// firings lack, ticks. Points of held firings get those firings' ticks; a point that fits
  /// neither loses its place (tick -1). Returns per tick whether it is that of a held firing.
  std::span<const std::uint8_t> find(std::span<FiringPlace> places,
                                     std::span<const std::int32_t> interpolated,
                                     int ticks_per_turn);

 private:
  std::vector<std::uint8_t> held_;        // per tick
  std::vector<std::int32_t> as_turning_;  // per tick: points, taking firings for interpolated
  std::vector<std::int32_t> as_held_;     // per tick: points, taking firings for held
  std::vector<std::int32_t> near_;        // per tick: as_turning_ of it and those beside it
  std::vector<std::int32_t> number_;      // per tick: how many held ones come before
  std::vector<std::uint8_t> has_point_;   // per held firing and beam
  std::vector<std::int32_t> votes_;       // per tick: points for held less those against
};

/// For each beam the part of its lag that the driver interpolates, ticks; 0 for all where no
/// firings are held. `ticks`: per beam, the ticks at which its points lie, in [0, ticks_per_turn);
/// `lags`: of the beams, which may have to change by the distance of two firings. Found where
/// points of a beam miss the firings of the others always by the same ticks.
[[nodiscard]] std::vector<std::int32_t> fit_interpolation(
    std::span<const std::vector<std::int32_t>> ticks, std::span<std::int32_t> lags,
    int ticks_per_turn);

/// The same where lags of nearly all beams are interpolated, so that a held firing's points lie
/// scattered, each at its beam's own distance from the firing. Found where points that fit no
/// firing, each beam's shifted by its own ticks, fall together. (scattered_holds.cpp)
[[nodiscard]] std::vector<std::int32_t> fit_scattered_holds(
    std::span<const std::vector<std::int32_t>> ticks, std::span<std::int32_t> lags,
    int ticks_per_turn);

}  // namespace sweepcast
