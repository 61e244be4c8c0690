// The twist of a deskewed sweep, found from its points: undoing it makes the beams' lines straight
// again, and the azimuths whole ticks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sensor/beam_azimuth.hpp"
#include "sensor/beam_lines.hpp"
#include "sweepcast/sensor_model.hpp"

namespace sweepcast {

/// The fastest turn that is looked for, radians a turn: 80 degrees a second at 10 Hz.
inline constexpr double kMaxYaw = 0.14;

/// Translation, metres, then rotation, radians; of a whole turn.
using TwistVector = std::array<double, 6>;

/// A sweep whose motion is looked for. `azimuth` clock, time 0 forward.
class MotionFitter {
 public:
  /// Takes every `stride`-th point.
  MotionFitter(const CloudView& cloud, std::size_t stride);

  /// Whether no point is far enough from the sensor to tell anything.
  [[nodiscard]] bool empty() const { return points_.empty(); }

  /// With nothing known: from the beams in front, where hardly any time has passed, outwards.
  /// Returns the twist but for its turn about z, which heights do not show;
  /// none where there are no beams.
  [[nodiscard]] std::optional<TwistVector> bootstrap(int max_beams);

  /// Straightens the lines again, from a twist that is nearly right; lines are found anew.
  [[nodiscard]] std::optional<TwistVector> settle(int max_beams, TwistVector twist);

  /// The encoder's ticks, from the steps between neighbouring points of a beam, which the motion
  /// hardly changes; 0 where there are none. After `bootstrap`.
  [[nodiscard]] int find_ticks();

  /// Adds to `twist` the turn about z at which the azimuths of each beam come back to whole ticks.
  /// Looks up to `reach` from `centre`, radians. Without a model lateral offsets are searched too.
  /// After `bootstrap` or `straighten`.
  void find_yaw(int ticks_per_turn, const SensorModel* model, double centre, double reach,
                TwistVector& twist);

  /// The twist but for its turn about z that straightens the lines of a model; from a guess, or
  /// from the front outwards.
  [[nodiscard]] TwistVector straighten(const SensorModel& model, const TwistVector* guess);

  /// Gauss-Newton on heights and azimuths at once, with the beams of a model.
  [[nodiscard]] TwistVector refine(const SensorModel& model, TwistVector twist);

 private:
  void undo(const TwistVector& twist);
  void assign(std::span<const BeamLine> lines);
  [[nodiscard]] TwistVector height_step(std::span<const BeamLine> lines, bool lines_free,
                                        double reach, double scale, TwistVector twist);

  std::vector<std::array<float, 3>> points_;  // deskewed
  std::vector<std::array<double, 3>> own_;    // the sensor's own, by the last `undo`
  std::vector<double> time_;
  std::vector<float> rho_, z_;
  std::vector<std::uint16_t> beam_;
  std::vector<BeamLine> lines_;
};

[[nodiscard]] Motion quantised_motion(const TwistVector& twist);
[[nodiscard]] TwistVector twist_vector(const Motion& motion);

/// The sensor's own points of a deskewed cloud. Without a model the time is that of the azimuth of
/// the point itself; NaN and the origin stay.
void undo_motion(const CloudView& cloud, const Motion& motion, PointCloud& own);

}  // namespace sweepcast
