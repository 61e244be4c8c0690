// What follows from a sensor model's integers, as doubles.
#pragma once

#include <vector>

#include "core/trig.hpp"
#include "sweepcast/sensor_model.hpp"

namespace sweepcast {

/// One beam. The same doubles on every machine.
struct BeamGeometry {
  double tan = 0.0;            ///< of the elevation
  double slant = 1.0;          ///< distance along the beam per horizontal distance
  double inverse_slant = 1.0;  ///< horizontal distance per distance along the beam
  double height_m = 0.0;
  double lateral_m = 0.0;
  double phase = 0.0;       ///< azimuth offset, ticks
  double azimuth = 0.0;     ///< azimuth offset and lag together, radians
  double time_turns = 0.0;  ///< time offset
};

[[nodiscard]] std::vector<BeamGeometry> beam_geometry(const SensorModel& model);

/// Whether some firings may be held.
[[nodiscard]] bool has_interpolated_lags(const SensorModel& model);

/// By beam, the ticks of its lag that held firings lack; empty where no firing is ever held.
[[nodiscard]] std::vector<std::int32_t> interpolated_lags(const SensorModel& model);

/// Turns by which a beam's lateral offset turns its points at a horizontal distance: the arc sine
/// of their ratio, to the third order.
[[nodiscard]] inline double lateral_turns(const BeamGeometry& beam, double rho) {
  const double q = beam.lateral_m / (rho > 1e-4 ? rho : 1.0);
  return (q + q * q * q / 6.0) / (2.0 * kPi);
}

}  // namespace sweepcast
