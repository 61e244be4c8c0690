// Odometry and its parts: rigid motions, the voxel map, registration, and the clock of a sweep.
#include "lab/odometry/odometry.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "lab/odometry/sweep_clock.hpp"

namespace sweepcast::lab {
namespace {

Points random_points(int count, double extent, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> along(-extent, extent);
  Points points;
  for (int i = 0; i < count; ++i) points.emplace_back(along(random), along(random), along(random));
  return points;
}

// The walls, floor and pillars of a room that has no symmetry.
Points room(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  Points points;
  for (int i = 0; i < 4000; ++i) {
    const double u = share(random), v = share(random);
    points.emplace_back(-8.0 + 20.0 * u, -6.0, 4.0 * v);
    points.emplace_back(12.0, -6.0 + 15.0 * u, 4.0 * v);
    points.emplace_back(-8.0 + 20.0 * u, -6.0 + 15.0 * v, -1.5);
    points.emplace_back(4.0 + 0.3 * std::cos(9.0 * u), 3.0 + 0.3 * std::sin(9.0 * u), 4.0 * v);
  }
  return points;
}

Twist twist_of(double x, double y, double z, double roll, double pitch, double yaw) {
  Twist twist;
  twist << x, y, z, roll, pitch, yaw;
  return twist;
}

TEST(Rigid, ExpOfAQuarterTurnOnACircleIsKnown) {
  // Driving a quarter circle of radius 2 to the left ends at (2, 2), facing left.
  const double quarter = std::numbers::pi / 2.0;
  const RigidTransform motion = exp(twist_of(2.0 * quarter, 0, 0, 0, 0, quarter));
  EXPECT_TRUE(motion.translation().isApprox(Eigen::Vector3d(2.0, 2.0, 0.0), 1e-12));
  EXPECT_TRUE((motion.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));
}

TEST(Rigid, LogIsTheInverseOfExp) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  for (const double scale : {1.5, 1e-3, 1e-8, 0.0}) {
    Twist twist;
    for (int i = 0; i < 6; ++i) twist[i] = scale * part(random);
    EXPECT_LT((log(exp(twist)) - twist).norm(), 1e-9) << scale;
  }
}

TEST(VoxelMap, NearestIsThatOfAFullSearchWithinACube) {
  VoxelMap map(1.0, 100.0);
  // Farther apart than the map's least distance, so that it holds them all.
  const Points points = thin_by_voxel(random_points(3000, 4.0, 1), 0.75, 7);
  Points held;
  for (const auto& point : points) {
    const bool is_near = std::any_of(held.begin(), held.end(),
                                     [&](const auto& h) { return (h - point).norm() < 0.3; });
    if (!is_near) held.push_back(point);
  }
  map.add(held, Eigen::Vector3d::Zero());
  ASSERT_EQ(map.size(), held.size());
  for (const auto& query : random_points(500, 4.0, 2)) {
    const auto best = std::min_element(held.begin(), held.end(), [&](const auto& a, const auto& b) {
      return (a - query).norm() < (b - query).norm();
    });
    if ((*best - query).norm() > 1.0) continue;
    const auto found = map.nearest(query);
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(*found, *best);
  }
  EXPECT_FALSE(map.nearest(Eigen::Vector3d(50.0, 0.0, 0.0)).has_value());
}

TEST(VoxelMap, ForgetsWhatIsOutOfRange) {
  VoxelMap map(1.0, 10.0);
  const Points points{{0.0, 0.0, 0.0}, {9.0, 0.0, 0.0}};
  map.add(points, Eigen::Vector3d::Zero());
  ASSERT_EQ(map.size(), 2U);
  map.add({}, Eigen::Vector3d(15.0, 0.0, 0.0));
  EXPECT_EQ(map.size(), 1U);
}

TEST(VoxelMap, ThinningKeepsOnePointACubeWhateverTheOrder) {
  Points points = random_points(2000, 3.0, 5);
  const Points thin = thin_by_voxel(points, 1.0, 1);
  EXPECT_EQ(thin.size(), 6U * 6U * 6U);
  std::shuffle(points.begin(), points.end(), std::mt19937(6));
  const Points again = thin_by_voxel(points, 1.0, 1);
  EXPECT_TRUE(std::is_permutation(thin.begin(), thin.end(), again.begin(), again.end()));
  EXPECT_FALSE(
      std::is_permutation(thin.begin(), thin.end(), thin_by_voxel(points, 1.0, 2).begin()));
}

TEST(Registration, FindsAKnownMotion) {
  VoxelMap map(0.5, 100.0);
  const Points scene = room(1);
  map.add(scene, Eigen::Vector3d::Zero());
  const RigidTransform pose = exp(twist_of(0.2, -0.1, 0.05, 0.01, -0.02, 0.03));
  // Other points of the same room, as seen from there.
  Points seen = thin_by_voxel(room(2), 0.4, 1);
  for (auto& point : seen) point = pose.inverse() * point;
  RegistrationOptions options;
  options.max_distance_m = 1.0;
  options.kernel = 0.05;
  const auto found = register_points(seen, map, RigidTransform::Identity(), options);
  const RigidTransform error = found.inverse() * pose;
  EXPECT_LT(error.translation().norm(), 0.02);
  EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), 0.003);
}

TEST(Registration, GivesTheGuessWhereNothingMatches) {
  VoxelMap map(0.5, 1000.0);
  const RigidTransform guess = exp(twist_of(1, 2, 3, 0, 0, 1));
  const Points points{{1.0, 0.0, 0.0}};
  EXPECT_TRUE(register_points(points, map, guess, {}).isApprox(guess));
  map.add(Points{{500.0, 0.0, 0.0}}, Eigen::Vector3d::Zero());
  EXPECT_TRUE(register_points(points, map, guess, {}).isApprox(guess));
  EXPECT_TRUE(register_points({}, map, guess, {}).isApprox(guess));
}

// What a sensor sees that turns clockwise from its back while it moves by `twist` a sweep.
PointCloud skewed_sweep(const Points& scene, const RigidTransform& end, const Twist& twist,
                        std::vector<float>& when) {
  PointCloud cloud;
  when.clear();
  for (const auto& point : scene) {
    double share = 0.5;
    Eigen::Vector3d seen = Eigen::Vector3d::Zero();
    for (int i = 0; i < 8; ++i) {  // the share follows from the azimuth, which follows from it
      seen = (end * exp((share - 1.0) * twist)).inverse() * point;
      share = 0.5 - std::atan2(seen.y(), seen.x()) / (2.0 * std::numbers::pi);
    }
    cloud.x.push_back(static_cast<float>(seen.x()));
    cloud.y.push_back(static_cast<float>(seen.y()));
    cloud.z.push_back(static_cast<float>(seen.z()));
    cloud.time_ns.push_back(std::llround(share * 1e8));
    when.push_back(static_cast<float>(share));
  }
  return cloud;
}

TEST(Odometry, FollowsASensorThatMovesWhileItTurns) {
  const Twist twist = twist_of(0.15, 0.0, 0.0, 0.0, 0.0, 0.02);
  OdometryOptions options;
  options.min_range_m = 0.5;
  options.max_range_m = 50.0;
  options.voxel_m = 0.5;
  Odometry odometry(options);
  RigidTransform pose = RigidTransform::Identity();
  std::vector<float> when;
  for (unsigned sweep = 0; sweep < 20; ++sweep) {
    const PointCloud cloud = skewed_sweep(room(sweep), pose, twist, when);
    const RigidTransform found = odometry.add(cloud, when);
    EXPECT_LT((found.translation() - pose.translation()).norm(), 0.12) << "sweep " << sweep;
    if (sweep < 19) pose = pose * exp(twist);
  }
  EXPECT_EQ(odometry.poses().size(), 20U);
  EXPECT_GT(pose.translation().norm(), 2.5);
}

TEST(Odometry, TakesSweepsWithoutAnyUsablePoint) {
  Odometry odometry(OdometryOptions{});
  PointCloud empty;
  PointCloud odd;
  for (const float value : {NAN, INFINITY, 0.0F}) {
    odd.x.push_back(value);
    odd.y.push_back(1.0F);
    odd.z.push_back(value);
  }
  for (const PointCloud* cloud : {&empty, &odd, &empty}) {
    EXPECT_TRUE(odometry.add(*cloud, {}).isApprox(RigidTransform::Identity()));
  }
  EXPECT_EQ(odometry.empty_sweeps(), 3U);
}

TEST(SweepClock, LearnsSenseAndStartFromTimes) {
  const Points scene = room(4);
  std::vector<float> when;
  const PointCloud cloud = skewed_sweep(scene, RigidTransform::Identity(), Twist::Zero(), when);
  const auto clock = SweepClock::learn(cloud);
  ASSERT_TRUE(clock.has_value());
  std::vector<float> told;
  clock->tell(cloud, told);
  ASSERT_EQ(told.size(), when.size());
  for (std::size_t i = 0; i < told.size(); ++i) {
    const double difference = std::abs(told[i] - when[i]);
    EXPECT_LT(std::min(difference, 1.0 - difference), 0.01) << i;
  }
}

TEST(SweepClock, KnowsNothingOfCloudsWithoutUsefulTimes) {
  std::vector<float> when;
  PointCloud cloud = skewed_sweep(room(4), RigidTransform::Identity(), Twist::Zero(), when);
  std::shuffle(cloud.time_ns.begin(), cloud.time_ns.end(), std::mt19937(1));
  EXPECT_FALSE(SweepClock::learn(cloud).has_value()) << "times that do not follow the azimuth";
  std::fill(cloud.time_ns.begin(), cloud.time_ns.end(), 5);
  EXPECT_FALSE(SweepClock::learn(cloud).has_value()) << "equal times";
  cloud.time_ns.clear();
  EXPECT_FALSE(SweepClock::learn(cloud).has_value()) << "no times";
}

}  // namespace
}  // namespace sweepcast::lab
