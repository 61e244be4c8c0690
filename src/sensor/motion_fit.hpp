// The motion of a deskewed sweep, found from its points: undoing it makes the beams' lines straight
// again, and the azimuths whole ticks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sensor/beam_azimuth.hpp"
#include "sensor/beam_geometry.hpp"
#include "sensor/beam_lines.hpp"
#include "sweepcast/sensor_model.hpp"

namespace sweepcast {

struct MotionPrior;

/// Least squares of a beam's time offset, turns.
struct TimeOffsetSums {
  double square = 0.0, product = 0.0;
};

/// The fastest turn that is looked for, radians a turn: 80 degrees a second at 10 Hz.
inline constexpr double kMaxYaw = 0.14;

/// A motion's numbers: translation, metres, and rotation, radians, of a whole turn; then the
/// mount's; then the nod.
using MotionVector = std::array<double, 13>;
inline constexpr std::size_t kNod = 12;

/// A sweep whose motion is looked for.
class MotionFitter {
 public:
  /// Takes every `stride`-th point. `zero`: the azimuth, in turns, where time is 0.
  MotionFitter(const CloudView& cloud, std::size_t stride, double zero = 0.0);

  /// Whether no point is far enough from the sensor to tell anything.
  [[nodiscard]] bool empty() const { return points_.empty(); }

  /// Where time is 0, turns; opposite to where the sweep begins and ends.
  [[nodiscard]] double zero() const { return zero_; }

  /// With nothing known: first the mount, then where the sweep begins and ends, and the twist, but
  /// for the turns about z, which heights do not show. None where there are no beams.
  [[nodiscard]] std::optional<MotionVector> bootstrap(int max_beams);

  /// Straightens the lines again, from a motion that is nearly right; lines are found anew.
  [[nodiscard]] std::optional<MotionVector> settle(int max_beams, MotionVector motion);

  /// The encoder's ticks, from the steps between neighbouring points of a beam, which the motion
  /// hardly changes; 0 where there are none. After `bootstrap`.
  [[nodiscard]] int find_ticks();

  /// Sets the twist's turn about z at which the azimuths of each beam come back to whole ticks.
  /// Looks up to `reach` from `centre`, radians. Without a model lateral offsets are searched too.
  /// After `bootstrap`, `settle` or `straighten`.
  void find_yaw(int ticks_per_turn, const SensorModel* model, double centre, double reach,
                MotionVector& motion);

  /// The motion but for its turns about z that straightens the lines of a model, from a guess;
  /// `outwards`: which may be wrong all over, so from the front, where no time has passed.
  [[nodiscard]] MotionVector straighten(const SensorModel& model, MotionVector guess,
                                        bool outwards);

  /// What the points of each beam say about its time offset. After `refine`.
  void add_time_offsets(const SensorModel& model, const MotionVector& motion,
                        std::span<TimeOffsetSums> sums) const;

  /// Gauss-Newton on heights and azimuths at once, with the beams of a model.
  [[nodiscard]] MotionVector refine(const SensorModel& model, MotionVector motion);

 private:
  void undo(const MotionVector& motion);
  void assign(std::span<const BeamLine> lines);
  [[nodiscard]] double height_error(std::size_t i) const;
  [[nodiscard]] double aside(std::size_t i, const BeamGeometry& beam, int ticks_per_turn) const;
  [[nodiscard]] MotionVector step_on_lines(double scale, const MotionVector& start,
                                           const MotionVector& motion);
  [[nodiscard]] MotionVector height_step(bool lines_free, double reach, double scale,
                                         MotionPrior prior, const MotionVector& motion);
  void relax(MotionVector& motion);
  void find_cut(const MotionVector& motion);

  std::vector<std::array<float, 3>> points_;  // deskewed
  std::vector<std::array<double, 3>> own_;    // the sensor's own, by the last `undo`
  std::vector<double> time_;
  std::vector<float> rho_, z_;
  std::vector<std::uint16_t> beam_;
  std::vector<BeamLine> lines_;
  std::vector<double> gap_;           // by beam: tangent to the nearest other, of a model's
  std::vector<double> time_offsets_;  // by beam, turns; empty where there are none
  double zero_ = 0.0;
};

/// `zero_tick`: where time is 0.
[[nodiscard]] Motion quantised_motion(const MotionVector& motion, int zero_tick);
[[nodiscard]] MotionVector motion_vector(const Motion& motion);

/// The sensor's own points of a deskewed cloud. `zero`: where time is 0, turns. NaN and the origin
/// stay. `model`: for the beams' time offsets; null: the time is that of the point's azimuth.
void undo_motion(const CloudView& cloud, const MotionVector& motion, double zero,
                 const SensorModel* model, PointCloud& own);

}  // namespace sweepcast
