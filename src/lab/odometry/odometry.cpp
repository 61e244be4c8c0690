#include "lab/odometry/odometry.hpp"

#include <cmath>
#include <cstdint>

namespace sweepcast::lab {

namespace {

// Of the map's cubes: the points that enter it, and those that are registered.
constexpr double kMapThinning = 0.5;
constexpr double kKeyThinning = 1.5;

}  // namespace

Odometry::Odometry(const OdometryOptions& options)
    : options_(options),
      map_(options.voxel_m, options.max_range_m),
      threshold_m_(options.initial_threshold_m) {}

RigidTransform Odometry::add(const PointCloud& cloud, std::span<const float> when) {
  const RigidTransform last = poses_.empty() ? RigidTransform::Identity() : poses_.back();
  const RigidTransform motion = predicted_motion();
  const std::uint64_t seed = 2 * poses_.size();
  Points to_map =
      thin_by_voxel(in_range(cloud, when, motion), options_.voxel_m * kMapThinning, seed);
  const Points keys = thin_by_voxel(to_map, options_.voxel_m * kKeyThinning, seed + 1);
  RegistrationOptions registration;
  registration.max_distance_m = 3.0 * threshold_m_;
  registration.kernel = threshold_m_ / 3.0;  // as in its released code, in m^2
  RigidTransform pose = register_points(keys, map_, last * motion, registration);

  learn_threshold((last * motion).inverse() * pose);
  for (Eigen::Vector3d& point : to_map) point = pose * point;
  map_.add(to_map, pose.translation());
  poses_.push_back(pose);
  return pose;
}

// Constant velocity: what it moved by during the last sweep.
RigidTransform Odometry::predicted_motion() const {
  const std::size_t count = poses_.size();
  if (count < 2) return RigidTransform::Identity();
  return poses_[count - 2].inverse() * poses_[count - 1];
}

// The finite points in range, as they would look from where the sensor is at the last firing.
Points Odometry::in_range(const PointCloud& cloud, std::span<const float> when,
                          const RigidTransform& motion) const {
  const Twist twist = log(motion);
  const bool is_skewed = !when.empty() && !twist.isZero();
  Points points;
  points.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d point(cloud.x[i], cloud.y[i], cloud.z[i]);
    const double range = point.norm();  // no number compares with NaN
    if (!(range > options_.min_range_m && range < options_.max_range_m)) continue;
    points.push_back(is_skewed ? exp((when[i] - 1.0) * twist) * point : point);
  }
  return points;
}

// The spread of what ICP had to correct, seen at the edge of the range (KISS-ICP, III.C).
void Odometry::learn_threshold(const RigidTransform& correction) {
  const double angle = Eigen::AngleAxisd(correction.linear()).angle();
  const double error =
      2.0 * options_.max_range_m * std::sin(angle / 2.0) + correction.translation().norm();
  if (poses_.empty() || error <= options_.min_motion_m) return;
  squared_corrections_ += error * error;
  ++corrections_;
  threshold_m_ = std::sqrt(squared_corrections_ / corrections_);
}

}  // namespace sweepcast::lab
