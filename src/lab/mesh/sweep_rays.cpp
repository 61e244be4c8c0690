#include "lab/mesh/sweep_rays.hpp"

namespace sweepcast::lab {

RigidTransform motion_during(std::span<const RigidTransform> poses, std::size_t index) {
  if (poses.size() < 2) return RigidTransform::Identity();
  const std::size_t end = index == 0 ? 1 : index;
  return poses[end - 1].inverse() * poses[end];
}

void rays_of(const PointCloud& cloud, std::span<const float> when, const RigidTransform& pose,
             const RigidTransform& motion, const RangeLimits& limits, std::vector<Ray>& rays) {
  const Twist twist = log(motion);
  const bool is_skewed = !when.empty() && !twist.isZero();
  rays.clear();
  rays.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d point(cloud.x[i], cloud.y[i], cloud.z[i]);
    const double range = point.norm();  // no number compares with NaN
    if (!(range > limits.min_m && range < limits.max_m)) continue;
    RigidTransform sensor = pose;
    if (is_skewed) sensor = pose * exp((when[i] - 1.0) * twist);
    rays.push_back({sensor.translation(), sensor * point});
  }
}

}  // namespace sweepcast::lab
