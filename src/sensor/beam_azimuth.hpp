// The azimuths of a spinning LiDAR: the ticks of its encoder, and where each beam looks and
// stands relative to them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/trig.hpp"
#include "sweepcast/sensor_model.hpp"

namespace sweepcast {

/// The points of one sweep, in columns, beams known.
struct BeamSamples {
  std::vector<float> turn;         ///< azimuth atan2(y, x) in turns, [0, 1)
  std::vector<float> inverse_rho;  ///< 1 / horizontal distance, 1/m
  std::vector<std::uint16_t> beam;

  [[nodiscard]] std::size_t size() const { return turn.size(); }
};

/// A beam's azimuth: turn = (tick + phase) / ticks_per_turn + lateral * inverse_rho / (2 pi).
struct BeamAzimuth {
  double phase = 0.0;  ///< ticks, [-1/2, 1/2)
  double lateral_m = 0.0;
  int lag = 0;             ///< ticks
  int interpolated = 0;    ///< ticks of the lag that held firings lack
  double coherence = 0.0;  ///< 1: every azimuth a whole tick; about 0: anywhere
};

/// Cosine and sine of a phase in turns, [-1/2, 1/2], by their series in half turns: to 2e-5, which
// is plenty for a mean, and several times as fast as to the last bit.
[[nodiscard]] inline SinCos unit_phasor(double turns) {
  const double u = 2.0 * turns;
  const double q = u * u;
  double cosine = -1.04638e-4;
  for (const double c :
       {0.00192957, -0.02580689, 0.23533063, -1.33526277, 4.05871213, -4.93480220, 1.0}) {
    cosine = cosine * q + c;
  }
  double sine = 4.66303e-4;
  for (const double c :
       {-0.00737043, 0.08214589, -0.59926453, 2.55016404, -5.16771278, 3.14159265}) {
    sine = sine * q + c;
  }
  return {sine * u, cosine};
}

/// The numbers of ticks that encoders have, rising.
[[nodiscard]] std::span<const int> encoder_ticks();

/// The encoder's ticks in a turn: of the numbers that encoders have, the smallest whose ticks the
/// azimuths return to as exactly as to any. 0 where they return to none.
[[nodiscard]] int find_ticks(std::span<const BeamSamples> sweeps, std::size_t beams);

/// Phase and lateral offset of each beam, from the coherence of its points' phases.
[[nodiscard]] std::vector<BeamAzimuth> fit_azimuths(std::span<const BeamSamples> sweeps,
                                                    std::size_t beams, int ticks_per_turn);

/// Sets each beam's lag: the shift at which its ticks best fall on those of the others. Where a
/// smaller shift does as well (firings at equal distances), the smaller.
void fit_lags(std::span<const BeamSamples> sweeps, int ticks_per_turn,
              std::span<BeamAzimuth> beams);

/// How held firings are looked for.
enum class HeldFit {
  some_beams,  ///< by beams whose lags are not interpolated: they fall on the held firing anyway
  all_beams,   ///< by points that fit no firing, where lags of nearly all beams are interpolated
};

/// Sets what part of the lags is interpolated, where some firings seem to be held; lags may change
/// by the distance of two firings.
void split_lags(std::span<const BeamSamples> sweeps, int ticks_per_turn, HeldFit fit,
                std::span<BeamAzimuth> beams);

}  // namespace sweepcast
