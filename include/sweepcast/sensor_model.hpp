// The geometry of a spinning LiDAR: what turns a beam's number, a firing and a range into a point.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sweepcast/cloud.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast {

// Units of the integers below. Encoder and decoder derive every double from the integers, by
// + - * / square root and core/trig.hpp alone, so that both get the same points to the bit.
inline constexpr std::int32_t kTangentUnits = 1 << 24;  ///< of tan_elevation, per 1
inline constexpr std::int32_t kLengthUnits = 100'000;   ///< of lengths, per metre: 10 um
inline constexpr std::int32_t kAngleUnits = 1'000'000;  ///< of angles, per degree
inline constexpr std::int32_t kRangeUnits = 10'000;     ///< of ranges, per metre: 0.1 mm

/// One beam. A point at horizontal distance rho = hypot(x, y) that the beam measures at tick t has
///   z           = rho * tan_elevation + height
///   atan2(y, x) = t * 360 deg / ticks_per_turn + azimuth_offset + asin(lateral_offset / rho)
/// Azimuths run counter-clockwise from x, seen from above. The beam measures at
/// t = firing tick + lag; all beams of one firing share the firing tick. Drivers work out part of
/// the lag from how far the sensor turns until the next firing; where they do not know (at a
/// packet's end) they hold the firing's azimuth, and t = firing tick + lag - interpolated.
struct Beam {
  std::int32_t tan_elevation = 0;   ///< 2^-24
  std::int32_t height = 0;          ///< 10 um, of the beam's origin above the sensor's
  std::int32_t azimuth_offset = 0;  ///< 1e-6 degree
  std::int32_t lateral_offset = 0;  ///< 10 um, of the beam's origin to the left of its direction
  std::int32_t lag = 0;             ///< ticks from the firing's to the beam's own, may be negative
  /// 1e-6 degree; what a motion's time is ahead of the beam's azimuth: 0 where sweeps are deskewed
  /// by azimuth, or not at all; else, deskewed by time stamps, the firing's azimuth less the
  /// beam's.
  std::int32_t time_offset = 0;
  std::int32_t interpolated = 0;  ///< ticks of the lag that held firings lack

  [[nodiscard]] bool operator==(const Beam&) const = default;
};

/// Where a sensor sits in the frame of its clouds, as in that of a vehicle: the cloud's point q is
/// the sensor's own p = R(rotation) q + translation, where R turns about the vector `rotation` by
/// its length.
struct Mount {
  std::array<std::int32_t, 3> translation{};  ///< 10 um
  std::array<std::int32_t, 3> rotation{};     ///< 1e-6 degree

  [[nodiscard]] bool operator==(const Mount&) const = default;
};

/// A spinning LiDAR.
struct SensorModel {
  std::int32_t ticks_per_turn = 0;  ///< steps of the azimuth encoder in a revolution
  std::int32_t direction = 0;       ///< +1 turns counter-clockwise, -1 clockwise, 0 not known
  /// Ticks by which beams of one firing may be off their lag, as where a driver rounds azimuths.
  std::int32_t jitter = 0;
  std::vector<Beam> beams;  ///< from the highest elevation down
  Mount mount;              ///< sensor <- cloud; all zero where clouds are in the sensor's frame

  [[nodiscard]] bool operator==(const SensorModel&) const = default;
};

inline constexpr std::int32_t kMaxBeams = 1024;
inline constexpr std::int32_t kMaxTicks = 1 << 20;

/// Whether the numbers of a model are within their bounds: 1 to kMaxBeams beams in order, 1 to
/// kMaxTicks ticks, |tan_elevation| at most 100, offsets of at most 10 m and 360 degrees, |lag| and
/// |interpolated| at most a turn, a mount of at most 100 m and 90 degrees. Error: invalid_argument,
/// with the number at fault.
[[nodiscard]] Status check(const SensorModel& model);

/// A constant twist that a deskewed sweep was moved by. The sensor's own point p relates to the
/// deskewed one q by  p = R(s * rotation) m + s * translation, m = mount applied to q, where R
/// turns about the vector `rotation` by its length. The time s is in turns, from -1/2 to 1/2, and
/// runs with the azimuth of p: s = (t - zero_tick) / ticks_per_turn, t the tick at which p was
/// measured, and the beam's own offsets added; then the beam's time offset. All six numbers are for
/// a whole turn.
struct Motion {
  std::array<std::int32_t, 3> translation{};  ///< 10 um
  std::array<std::int32_t, 3> rotation{};     ///< 1e-6 degree
  std::int32_t zero_tick = 0;                 ///< where s is 0; 0 is forward
  /// Nodding once a turn, which a twist does not have: the sensor's own points are lower by their
  /// horizontal distance times this; 2^-24.
  std::int32_t nod = 0;
  /// Takes the place of the model's: where sweeps are brought to the time at which they begin or
  /// end, it follows the speed.
  Mount mount;

  [[nodiscard]] bool operator==(const Motion&) const = default;
};

/// Whether a motion is within its bounds: |translation| at most 1 km and |rotation| 90 degrees a
/// turn each, |zero_tick| at most a turn, the mount as in a model. Error: invalid_argument.
[[nodiscard]] Status check(const Motion& motion, const SensorModel& model);

/// How well a model explains points.
struct SensorResiduals {
  std::size_t points = 0;        ///< finite points with a range
  double height_median_m = 0.0;  ///< of |z - (rho tan_elevation + height)|
  double height_p95_m = 0.0;
  double height_p99_m = 0.0;
  double azimuth_median_deg = 0.0;  ///< of the distance to the nearest whole tick
  double azimuth_p95_deg = 0.0;
  double azimuth_p99_deg = 0.0;
  double share_5mm = 0.0;  ///< of points that a cell of the beam grid holds within 5 mm (3-D) ...
  double share_2cm = 0.0;
  double share_5cm = 0.0;
  /// Median of |height residual| over half the distance to the neighbouring beams: 0 where beams
  /// are crisp, 0.5 where points lie anywhere.
  double blur = 0.0;
};

/// What `estimate_sensor_model` found.
struct SensorEstimate {
  SensorModel model;
  SensorResiduals residuals;    ///< over all sweeps, with the integers of `model`
  std::vector<Motion> motions;  ///< one a sweep where the sweeps are deskewed; else empty
};

struct SensorEstimateOptions {
  std::size_t max_points = 400'000;  ///< points that are looked at; more are thinned evenly
  std::int32_t max_beams = 256;
  std::int32_t ticks_per_turn = 0;  ///< 0: find out
  bool use_ring = true;             ///< trust the ring column where there is one
  bool undo_motion = true;          ///< look for a twist where the beams are blurred
};

/// Finds the model of the sensor that made these sweeps, from their points alone: any order, no
/// ring needed. Sweeps must be of one sensor; a few are better than one.
/// Errors: invalid_argument (no sweep, too few points), unsupported: the points do not lie on the
/// cones of a spinning LiDAR's beams; the message has the share that the best model explains.
[[nodiscard]] Result<SensorEstimate> estimate_sensor_model(
    std::span<const CloudView> sweeps, const SensorEstimateOptions& options = {});

/// Finds the twist that a sweep was deskewed by, and its mount, the sensor's model known. `guess`:
/// the motion of the sweep before, where there is one; null searches all, from the model's mount,
/// for a sweep that begins and ends behind the sensor.
[[nodiscard]] Motion estimate_motion(const CloudView& cloud, const SensorModel& model,
                                     const Motion* guess);

}  // namespace sweepcast
