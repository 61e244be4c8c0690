// The rays of a sweep: from where the sensor was at each firing to what it met.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "lab/odometry/rigid.hpp"
#include "sweepcast/cloud.hpp"

namespace sweepcast::lab {

struct Ray {
  Eigen::Vector3d origin;  ///< metres, the map's frame
  Eigen::Vector3d end;
};

struct RangeLimits {
  double min_m = 2.0;  ///< nearer points are the robot itself
  double max_m = 70.0;
};

/// How the sensor moved during sweep `index`, whose pose is that at its last firing: as between the
/// last pose and this one (the first sweep: this and the next).
[[nodiscard]] RigidTransform motion_during(std::span<const RigidTransform> poses,
                                           std::size_t index);

/// The rays of the cloud's points that are in range, NaN passed over. `when` says at which share of
/// the sweep each point was measured, in the sensor's frame of that time (0: first firing, 1:
/// last); it is empty where all points are in the frame of `pose`. `motion` is the sensor's during
/// the sweep. Replaces what is in `rays`.
void rays_of(const PointCloud& cloud, std::span<const float> when, const RigidTransform& pose,
             const RigidTransform& motion, const RangeLimits& limits, std::vector<Ray>& rays);

}  // namespace sweepcast::lab
