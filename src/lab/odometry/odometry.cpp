#include "lab/odometry/odometry.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sweepcast::lab {

namespace {

// Of a map's cubes: the points that enter it, and those that are registered.
constexpr double kMapThinning = 0.5;
constexpr double kKeyThinning = 1.5;

// The coarsest map's cubes, at least, in metres; and what a map leaves to the next, of its cubes.
constexpr double kCoarsest_m = 2.0;
constexpr double kLeftShare = 0.2;

constexpr int kStartRounds = 3;  // what a further one changes is below a centimetre

std::vector<VoxelMap> maps_down_to(double voxel_m, double range_m) {
  std::vector<VoxelMap> maps;
  double size_m = voxel_m;
  while (size_m < kCoarsest_m) size_m *= 2.0;
  for (; size_m >= voxel_m; size_m /= 2.0) maps.emplace_back(size_m, range_m);
  return maps;
}

// As they would look from where the sensor is at the last firing, if it moved by `motion` since the
// first.
Points deskewed(const Points& points, std::span<const float> when, const RigidTransform& motion) {
  const Twist twist = log(motion);
  if (when.empty() || twist.isZero()) return points;
  Points moved(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    moved[i] = exp((when[i] - 1.0) * twist) * points[i];
  }
  return moved;
}

RegistrationOptions within(double threshold_m) {
  RegistrationOptions options;
  options.max_distance_m = 3.0 * threshold_m;
  options.kernel = threshold_m / 3.0;  // as in KISS-ICP's released code, in m^2
  return options;
}

}  // namespace

Odometry::Odometry(const OdometryOptions& options)
    : options_(options),
      maps_(maps_down_to(options.voxel_m, options.max_range_m)),
      threshold_m_(options.initial_threshold_m) {}

RigidTransform Odometry::add(const PointCloud& cloud, std::span<const float> when) {
  Sweep sweep = in_range(cloud, when);
  if (sweep.points.empty()) ++empty_sweeps_;
  if (poses_.empty()) {
    insert(thinned(sweep.points, 0), RigidTransform::Identity());
    first_ = std::move(sweep);
    return poses_.emplace_back(RigidTransform::Identity());
  }
  const RigidTransform motion = poses_.size() == 1 ? first_motion(sweep) : predicted_motion();
  Layers layers = thinned(deskewed(sweep.points, sweep.when, motion), poses_.size());
  const RigidTransform guess = poses_.back() * motion;
  const RigidTransform pose = find(layers, guess);
  learn_threshold(guess.inverse() * pose);
  insert(std::move(layers), pose);
  return poses_.emplace_back(pose);
}

// The finite points in range.
Odometry::Sweep Odometry::in_range(const PointCloud& cloud, std::span<const float> when) const {
  Sweep sweep;
  sweep.points.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d point(cloud.x[i], cloud.y[i], cloud.z[i]);
    const double range = point.norm();  // no number compares with NaN
    if (!(range > options_.min_range_m && range < options_.max_range_m)) continue;
    sweep.points.push_back(point);
    if (!when.empty()) sweep.when.push_back(when[i]);
  }
  return sweep;
}

// From the first sweep to the second, none known before: found with both askew, then again with
// both deskewed by what was found.
RigidTransform Odometry::first_motion(const Sweep& second) {
  RigidTransform motion = RigidTransform::Identity();
  for (int round = 0; round < kStartRounds; ++round) {
    motion = find(thinned(deskewed(second.points, second.when, motion), 1), motion);
    for (VoxelMap& map : maps_) map.clear();
    insert(thinned(deskewed(first_.points, first_.when, motion), 0), poses_.front());
  }
  first_ = {};
  return motion;
}

// Of the number-th sweep's points, those for each map. Two sweeps must differ in what decides among
// a cube's points.
Odometry::Layers Odometry::thinned(const Points& points, std::uint64_t number) const {
  Layers layers;
  for (const VoxelMap& map : maps_) {
    layers.push_back(thin_by_voxel(points, map.voxel_m() * kMapThinning, 2 * number));
  }
  return layers;
}

// The pose of the next sweep, deskewed, in the maps' frame, from a guess of it.
RigidTransform Odometry::find(const Layers& layers, RigidTransform pose) const {
  double threshold_m = threshold_m_;
  for (std::size_t i = 0; i < maps_.size(); ++i) {
    const double voxel_m = maps_[i].voxel_m();
    const Points keys = thin_by_voxel(layers[i], voxel_m * kKeyThinning, 2 * poses_.size() + 1);
    pose = register_points(keys, maps_[i], pose, within(threshold_m));
    threshold_m = std::min(threshold_m, kLeftShare * voxel_m);
  }
  return pose;
}

void Odometry::insert(Layers layers, const RigidTransform& pose) {
  for (std::size_t i = 0; i < maps_.size(); ++i) {
    for (Eigen::Vector3d& point : layers[i]) point = pose * point;
    maps_[i].add(layers[i], pose.translation());
  }
}

// Constant velocity: what it moved by during the last sweep.
RigidTransform Odometry::predicted_motion() const {
  const std::size_t count = poses_.size();
  return poses_[count - 2].inverse() * poses_[count - 1];
}

// The spread of what ICP had to correct, seen at the edge of the range (KISS-ICP, III.C).
void Odometry::learn_threshold(const RigidTransform& correction) {
  const double angle = Eigen::AngleAxisd(correction.linear()).angle();
  const double error =
      2.0 * options_.max_range_m * std::sin(angle / 2.0) + correction.translation().norm();
  if (error <= options_.min_motion_m) return;
  squared_corrections_ += error * error;
  ++corrections_;
  threshold_m_ = std::sqrt(squared_corrections_ / corrections_);
}

}  // namespace sweepcast::lab
