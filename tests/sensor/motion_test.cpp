#include "sensor/motion.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "lab/real_sweeps.hpp"
#include "sensor/beam_grid.hpp"
#include "sensor/spinning_lidar.hpp"

namespace sweepcast {
namespace {

using Vector = std::array<double, 3>;

/// R(w) p by many small turns: another route than a power series.
Vector turned(Vector p, const Vector& w) {
  constexpr int kSteps = 20'000;
  for (int i = 0; i < kSteps; ++i) {
    const Vector little{w[0] / kSteps, w[1] / kSteps, w[2] / kSteps};
    const auto cross = [&](const Vector& q) {
      return Vector{little[1] * q[2] - little[2] * q[1], little[2] * q[0] - little[0] * q[2],
                    little[0] * q[1] - little[1] * q[0]};
    };
    const Vector c = cross(p);
    const Vector d = cross(c);
    for (std::size_t n = 0; n < 3; ++n) p[n] += c[n] + d[n] / 2;
  }
  return p;
}

Motion made_up_motion() {
  return {{81'000, 3'000, -1'500}, {200'000, -300'000, 2'000'000}, 0, 0, {}};
}

/// Beside and above the cloud's origin, tilted by a degree.
Mount made_up_mount() {
  return {{-3'000, -61'000, -187'000}, {-900'000, 150'000, 0}};
}

/// What deskewing by a motion makes of the sensor's own points. The time is s + `ahead`, turns.
PointCloud deskewed(const PointCloud& own, const Motion& motion, double ticks_per_turn = 2000.0,
                    double ahead = 0.0) {
  const Twist<double> twist(motion);
  const Twist<double> mount(motion.mount);
  PointCloud cloud;
  for (std::size_t i = 0; i < own.size(); ++i) {
    const double azimuth = std::atan2(own.y[i], own.x[i]) / (2.0 * kPi);
    const double s = std::remainder(azimuth - motion.zero_tick / ticks_per_turn, 1.0) + ahead;
    const double z = own.z[i] + motion.nod / 16777216.0 * std::hypot(own.x[i], own.y[i]);
    test::push(cloud, mount.redo(twist.redo({own.x[i], own.y[i], z}, s), 1.0));
  }
  return cloud;
}

/// The farthest that a point's cell is from the point, metres. Left out are strays, and a point in
/// a thousand: where the sweep begins and ends, a point's time is ambiguous.
double worst_error(const SensorModel& model, const PointCloud& cloud, const Motion& motion) {
  BeamGridOptions options;
  options.motion = motion;
  BeamImage image;
  BeamProjector(model).project(cloud, options, image);
  EXPECT_LT(image.extras.size(), cloud.size() / 500);
  PointCloud back;
  BeamUnprojector(model).unproject(image, back);
  std::vector<double> errors;
  std::size_t at = 0;
  for (const std::uint32_t i : image.point) {
    if (i == kNoPoint) continue;
    errors.push_back(test::distance(cloud, i, back, at));
    ++at;
  }
  std::sort(errors.begin(), errors.end());
  return errors[errors.size() - 1 - errors.size() / 1000];
}

TEST(Motion, TurnsAboutItsVector) {
  Motion motion;
  motion.rotation = {10'000'000, -20'000'000, 60'000'000};
  const Vector w{10 / test::kRadian, -20 / test::kRadian, 60 / test::kRadian};
  const Vector q{3.0, -2.0, 0.5};
  const Vector p = Twist<double>(motion).undo(q, 0.5);
  const Vector expected = turned(q, {w[0] / 2, w[1] / 2, w[2] / 2});
  for (std::size_t n = 0; n < 3; ++n) EXPECT_NEAR(p[n], expected[n], 1e-7);
}

TEST(Motion, RedoIsTheInverseOfUndo) {
  std::mt19937 random(1);
  const Twist<double> twist(
      {{81'000, 3'000, -1'500}, {2'000'000, -3'000'000, 30'000'000}, 0, 0, {}});
  for (int i = 0; i < 1000; ++i) {
    const Vector q{test::uniform(random, -80, 80), test::uniform(random, -80, 80),
                   test::uniform(random, -3, 3)};
    const double s = test::uniform(random, -0.5, 0.5);
    const Vector back = twist.redo(twist.undo(q, s), s);
    for (std::size_t n = 0; n < 3; ++n) ASSERT_NEAR(back[n], q[n], 1e-9);
  }
}

TEST(Motion, TimeRunsFromMinusHalfToHalfATurn) {
  Motion motion;
  motion.zero_tick = 100;
  EXPECT_EQ(motion_time(100, motion, 1000), 0.0);
  EXPECT_EQ(motion_time(350, motion, 1000), 0.25);
  EXPECT_EQ(motion_time(599, motion, 1000), 0.499);
  EXPECT_EQ(motion_time(600, motion, 1000), -0.5);
  EXPECT_EQ(motion_time(-900, motion, 1000), 0.0);
  EXPECT_EQ(motion_time(5100 + 1, motion, 1000), 0.001);
}

TEST(Motion, GridHoldsADeskewedSweepAsWellAsARawOne) {
  std::mt19937 random(2);
  const SensorModel model = test::made_up_model();
  const PointCloud cloud = deskewed(test::sweep_of(model, random), made_up_motion());
  EXPECT_LT(worst_error(model, cloud, made_up_motion()), 0.0003);
}

TEST(Motion, IsFoundWhenTheModelIsKnown) {
  std::mt19937 random(3);
  const SensorModel model = test::made_up_model();
  const Motion truth = made_up_motion();
  const PointCloud cloud = deskewed(test::sweep_of(model, random, 0.001), truth);
  const Motion found = estimate_motion(cloud, model, nullptr);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_NEAR(found.translation[n], truth.translation[n], 100) << n;  // 1 mm
    EXPECT_NEAR(found.rotation[n], truth.rotation[n], 4'000) << n;      // 0.004 degrees
  }
}

TEST(Motion, GridHoldsASweepInAVehiclesFrame) {
  std::mt19937 random(4);
  SensorModel model = test::made_up_model();
  for (Beam& beam : model.beams) beam.time_offset = 2'000'000;
  Motion motion = made_up_motion();
  motion.mount = made_up_mount();
  motion.zero_tick = 500;
  motion.nod = -5'000;
  const PointCloud cloud =
      deskewed(test::sweep_of(model, random), motion, model.ticks_per_turn, 2.0 / 360.0);
  EXPECT_LT(worst_error(model, cloud, motion), 0.0003);
}

TEST(Motion, MountAloneIsUndoneToo) {
  std::mt19937 random(5);
  SensorModel model = test::made_up_model();
  model.mount = made_up_mount();
  Motion still;
  still.mount = model.mount;
  PointCloud cloud = deskewed(test::sweep_of(model, random), still);
  test::push(cloud, {0.0, 0.0, 0.0});  // "no return"
  BeamImage image;
  BeamProjector(model).project(cloud, {}, image);
  ASSERT_EQ(image.extras.size(), 1U);
  EXPECT_EQ(image.extras[0].reason, ExtraReason::zero_range);
  PointCloud back;
  BeamUnprojector(model).unproject(image, back);
  std::size_t at = 0;
  for (const std::uint32_t i : image.point) {
    if (i == kNoPoint) continue;
    ASSERT_LT(test::distance(cloud, i, back, at), 0.0003) << i;
    ++at;
  }
}

TEST(Motion, FollowsFromTheSweepBefore) {
  std::mt19937 random(6);
  SensorModel model = test::made_up_model();
  Motion before = made_up_motion();
  before.mount = made_up_mount();
  before.zero_tick = 500;
  Motion truth = before;
  truth.translation[0] += 3'000;
  truth.rotation[2] += 300'000;
  truth.mount.translation[0] += 1'500;
  truth.nod = 3'000;  // 0.18 milliradians
  const PointCloud cloud = deskewed(test::sweep_of(model, random, 0.001), truth);
  const Motion found = estimate_motion(cloud, model, &before);
  EXPECT_EQ(found.zero_tick, 500);
  EXPECT_NEAR(found.nod, truth.nod, 300);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_NEAR(found.translation[n], truth.translation[n], 200) << n;  // 2 mm
    EXPECT_NEAR(found.rotation[n], truth.rotation[n], 8'000) << n;
    EXPECT_NEAR(found.mount.translation[n], truth.mount.translation[n], 200) << n;
  }
}

TEST(Motion, OfAVehiclesSweepIsFoundBlindWithItsMount) {
  std::mt19937 random(7);
  const SensorModel truth = test::made_up_model();
  Motion motion = made_up_motion();
  motion.mount = made_up_mount();
  motion.zero_tick = 500;
  const PointCloud cloud = deskewed(test::sweep_of(truth, random), motion);
  const std::vector<CloudView> views{cloud};
  const auto estimate = estimate_sensor_model(views);
  ASSERT_TRUE(estimate) << estimate.error().message;
  EXPECT_EQ(estimate->model.beams.size(), truth.beams.size());
  EXPECT_EQ(estimate->model.ticks_per_turn, truth.ticks_per_turn);
  ASSERT_EQ(estimate->motions.size(), 1U);
  const Motion& found = estimate->motions[0];
  EXPECT_NEAR(found.zero_tick, motion.zero_tick, 20);
  for (std::size_t n = 0; n < 2; ++n) {
    EXPECT_NEAR(found.translation[n], motion.translation[n], 1'000) << n;  // 1 cm
    EXPECT_NEAR(found.mount.translation[n], motion.mount.translation[n], 2'000) << n;
    EXPECT_NEAR(found.mount.rotation[n], motion.mount.rotation[n], 20'000) << n;
  }
  // The mount's height and the beams' own make up for each other.
  const double height = estimate->model.beams[0].height - found.mount.translation[2];
  EXPECT_NEAR(height, truth.beams[0].height - motion.mount.translation[2], 500);
  EXPECT_GT(estimate->residuals.share_5mm, 0.99);
}

/// The estimate from the first two sweeps of a folder; empty where there are none.
std::optional<Result<SensorEstimate>> estimate_blind(const char* folder) {
  const auto paths = lab::real_sweeps(folder);
  if (paths.size() < 2) return std::nullopt;
  const std::vector<PointCloud> clouds{lab::read_kitti(paths[0]), lab::read_kitti(paths[1])};
  const std::vector<CloudView> views(clouds.begin(), clouds.end());
  return estimate_sensor_model(views);
}

/// What the estimates of both deskewed sets show. `share_5mm`: the least that must lie so near.
void expect_found(const SensorEstimate& estimate, std::int32_t ticks, double share_5mm) {
  EXPECT_EQ(estimate.model.beams.size(), 64U);
  EXPECT_EQ(estimate.model.ticks_per_turn, ticks);
  EXPECT_LT(estimate.residuals.height_median_m, 0.0004);
  EXPECT_GT(estimate.residuals.share_5mm, share_5mm);
}

TEST(Motion, OfPandaSetIsFoundBlind) {
  const auto estimate = estimate_blind("pandaset_pandar64");
  if (!estimate) GTEST_SKIP() << "needs SWEEPCAST_DATA";
  ASSERT_TRUE(*estimate) << estimate->error().message;
  expect_found(**estimate, 1800, 0.98);
  ASSERT_EQ((*estimate)->motions.size(), 2U);
  // 1.13 m/s at 10 Hz, along y.
  EXPECT_NEAR((*estimate)->motions[0].translation[1], 11'100, 1'000);
}

TEST(Motion, OfDeskewedKittiSweepsIsFoundBlind) {
  const auto estimate = estimate_blind("kitti_odom00");
  if (!estimate) GTEST_SKIP() << "needs SWEEPCAST_DATA";
  ASSERT_TRUE(*estimate) << estimate->error().message;
  expect_found(**estimate, 4000, 0.999);
  ASSERT_EQ((*estimate)->motions.size(), 2U);
  // The poses beside the sweeps: 0.82 m from the first to the second, at 10 Hz.
  EXPECT_NEAR((*estimate)->motions[0].translation[0], 82'500, 2'500);
}

}  // namespace
}  // namespace sweepcast
