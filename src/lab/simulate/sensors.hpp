// The beam geometry and timing of the simulated sensors.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sweepcast::lab {

/// One laser. At shaft azimuth `tick` (whole) it measures along
///   azimuth = (tick + lag_ticks) * tick_deg + azimuth_offset_deg, from the point that lies
///   `lateral_m` to the left of that direction and `height_m` above the origin; so in a sweep
///   z = rho * tan_elevation + height, atan2(y, x) = azimuth + lateral / rho (radians),
/// rho the horizontal distance. Azimuths run counter-clockwise from x, seen from above.
struct Beam {
  double tan_elevation = 0.0;
  double height_m = 0.0;
  double azimuth_offset_deg = 0.0;
  double lateral_m = 0.0;
  int lag_ticks = 0;
  double gain = 1.0;  ///< on intensity: lasers and their detectors are not alike

  std::int64_t delay_ns = 0;  ///< from the firing's time to this laser's pulse
};

/// A spinning LiDAR at 10 Hz. It turns clockwise, seen from above; a sweep begins at the rear.
struct Sensor {
  std::string name;
  std::vector<Beam> beams;        ///< by ring
  std::vector<int> firing_order;  ///< rings in the order of their pulses
  int ticks_per_turn = 0;
  /// Nanoseconds from firing to firing, as a fraction.
  std::int64_t period_num = 1;
  std::int64_t period_den = 1;
  double range_sigma_m = 0.0;
  double range_step_m = 0.0;  ///< the sensor's own quantisation
  double reach_m = 0.0;       ///< a wall of 25 % albedo facing the beam returns every second pulse
  double min_range_m = 0.0;
  double max_range_m = 120.0;
  double mount_height_m = 1.73;  ///< the origin above the road
  double intensity_scale = 1.0;  ///< intensity of a white wall facing the beam
  double intensity_step = 0.01;
  double intensity_max = 0.99;
  bool millimetres = false;  ///< coordinates rounded to 1 mm, as KITTI's files have them
  bool ring_major = false;   ///< points by ring, each ring from azimuth 0 upward; else by time

  [[nodiscard]] double tick_deg() const { return 360.0 / ticks_per_turn; }
  /// First firing of a sweep, counted from the drive's start.
  [[nodiscard]] std::int64_t first_firing(int sweep) const;
  /// Nanoseconds from the drive's start.
  [[nodiscard]] std::int64_t time_ns(std::int64_t firing) const;
  /// The shaft's azimuth at a firing, in ticks, in [0, ticks_per_turn).
  [[nodiscard]] int azimuth_tick(std::int64_t firing) const;
};

/// The sensors by name: "hdl64", "vlp16", "os1-128"; none for others.
[[nodiscard]] std::optional<Sensor> find_sensor(std::string_view name);

}  // namespace sweepcast::lab
