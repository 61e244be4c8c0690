// Finds each point's beam, the tick at which the beam looked there, and the range: many points at
// once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sensor/beam_lines.hpp"
#include "sweepcast/sensor_model.hpp"

namespace sweepcast {

/// Where up to `kSize` points lie in the sensor's own terms.
struct LocatedPoints {
  static constexpr std::size_t kSize = 512;
  std::array<float, kSize> rho;           ///< horizontal distance, metres
  std::array<float, kSize> turns;         ///< azimuth, in turns, from -1/2 to 1/2
  std::array<float, kSize> height_error;  ///< above the beam's line, metres
  std::array<float, kSize> miss;          ///< from the tick's centre, ticks
  std::array<std::int32_t, kSize> beam;
  std::array<std::int32_t, kSize> firing;  ///< tick less the beam's lag, in [0, ticks_per_turn)
  std::array<std::int32_t, kSize> range;   ///< along the beam, 0.1 mm
  std::array<std::int32_t, kSize> found;   ///< 1; 0 where the other numbers mean nothing
};

/// Finds points' places under one sensor model.
class BeamLocator {
 public:
  /// The model must have passed `check`.
  explicit BeamLocator(const SensorModel& model);

  /// Locates points, at most LocatedPoints::kSize, given in metres in the sensor's frame. Not found
  /// are those that are not finite, at the origin, beyond 100 km, farther than `max_height_error`
  /// from the nearest beam, or nearer than twice the beam's lateral offset.
  void locate(std::span<const float> x, std::span<const float> y, std::span<const float> z,
              float max_height_error, LocatedPoints& out) const;

  /// The beam whose line is nearest to (rho, z), rho above 0, metres.
  [[nodiscard]] std::size_t nearest_beam(float rho, float z) const {
    return table_.nearest(rho, z);
  }

 private:
  void locate_points(std::span<const float> x, std::span<const float> y, std::span<const float> z,
                     float max_height_error, LocatedPoints& out) const;
  void locate_avx2(std::span<const float> x, std::span<const float> y, std::span<const float> z,
                   float max_height_error, LocatedPoints& out) const;

  struct Beam {
    float tan, inverse_slant, height, lateral, phase;
    std::int32_t lag;
  };
  std::vector<Beam> beams_;
  std::int32_t ticks_;
  LineTable table_;
};

}  // namespace sweepcast
