// At which share of its sweep a spinning sensor measured a point, told from the point's azimuth:
// decoded clouds have no times unless their codec carries them, and all must be deskewed alike.
#pragma once

#include <optional>
#include <vector>

#include "sweepcast/cloud.hpp"

namespace sweepcast::lab {

/// A sensor that turns once a sweep, at constant speed.
class SweepClock {
 public:
  /// Learns direction and start from a cloud with times. Nothing where it has none, where all
  /// points have the same, or where times do not follow the azimuth (a sensor that does not spin).
  [[nodiscard]] static std::optional<SweepClock> learn(const PointCloud& timed);

  /// The share of the sweep, 0 to 1, at which each point of a cloud in the sensor's frame was
  /// measured; 0 for points without an azimuth.
  void tell(const PointCloud& cloud, std::vector<float>& when) const;

 private:
  SweepClock(double sense, double start) : sense_(sense), start_(start) {}
  double sense_;  ///< 1 where it turns counter-clockwise seen from above, else -1
  double start_;  ///< turns: what the azimuth, times the sense, lacks to the share
};

}  // namespace sweepcast::lab
