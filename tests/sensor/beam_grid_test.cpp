#include "sensor/beam_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "lab/real_sweeps.hpp"
#include "sensor/spinning_lidar.hpp"

namespace sweepcast {
namespace {

using test::distance;
using test::made_up_model;
using test::point_of;
using test::push;
using test::sweep_of;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

BeamImage project(const SensorModel& model, const PointCloud& cloud,
                  const BeamGridOptions& options = {}) {
  BeamImage image;
  BeamProjector(model).project(cloud, options, image);
  return image;
}

PointCloud unproject(const SensorModel& model, const BeamImage& image) {
  PointCloud cloud;
  BeamUnprojector(model).unproject(image, cloud);
  return cloud;
}

/// The largest distance of a cell's point from where the image puts it.
double worst_error(const SensorModel& model, const PointCloud& cloud, const BeamImage& image) {
  const PointCloud back = unproject(model, image);
  double worst = 0.0;
  std::size_t at = 0;
  for (const std::uint32_t i : image.point) {
    if (i != kNoPoint) worst = std::max(worst, distance(cloud, i, back, at++));
  }
  EXPECT_EQ(at, back.size());
  return worst;
}

/// Every point is in one cell or one extra.
void expect_all_there(const BeamImage& image, std::size_t points) {
  std::multiset<std::uint32_t> seen;
  for (const std::uint32_t i : image.point) {
    if (i != kNoPoint) seen.insert(i);
  }
  for (const ExtraPoint& extra : image.extras) seen.insert(extra.point);
  ASSERT_EQ(seen.size(), points);
  std::uint32_t next = 0;
  for (const std::uint32_t i : seen) ASSERT_EQ(i, next++);
}

TEST(BeamGrid, PutsEveryPointWhereItWasMeasured) {
  std::mt19937 random(1);
  const SensorModel model = made_up_model();
  const PointCloud cloud = sweep_of(model, random);
  const BeamImage image = project(model, cloud);
  expect_all_there(image, cloud.size());
  EXPECT_TRUE(image.extras.empty());
  EXPECT_EQ(image.rows, 16);
  const std::vector<int> firings = test::firings(model);
  EXPECT_TRUE(std::equal(firings.begin(), firings.end(), image.firing_tick.begin(),
                         image.firing_tick.end()));
  EXPECT_LT(worst_error(model, cloud, image), 0.0001);
}

TEST(BeamGrid, CellOfAKnownPoint) {
  const SensorModel model = made_up_model();
  PointCloud cloud;
  push(cloud, point_of(model, 3, 100, 12.5));
  push(cloud, point_of(model, 9, 1990, 4.0));
  const BeamImage image = project(model, cloud);
  ASSERT_EQ(image.cols, 2);
  EXPECT_EQ(image.firing_tick, (std::vector<std::int32_t>{100, 1990}));
  const double tangent = model.beams[3].tan_elevation / 16777216.0;
  EXPECT_NEAR(image.range[3 * 2 + 0], 12.5e4 * std::sqrt(1.0 + tangent * tangent), 1.0);
  EXPECT_EQ(image.point[3 * 2 + 0], 0U);
  EXPECT_EQ(image.point[9 * 2 + 1], 1U);
  EXPECT_EQ(std::count(image.range.begin(), image.range.end(), 0), 30);
}

TEST(BeamGrid, ListsWhatHasNoCell) {
  const SensorModel model = made_up_model();
  PointCloud cloud;
  push(cloud, point_of(model, 5, 40, 10.0));
  push(cloud, {kNan, 1.0, 1.0});
  push(cloud, {0.0, 0.0, 0.0});
  push(cloud, point_of(model, 5, 40, 20.0));  // a second return
  push(cloud, {3.0, 0.0, 30.0});              // straight up
  push(cloud, {std::numeric_limits<double>::infinity(), 0.0, 0.0});
  push(cloud, {1e30, 0.0, 0.0});
  const BeamImage image = project(model, cloud);
  expect_all_there(image, cloud.size());
  ASSERT_EQ(image.extras.size(), 6U);
  constexpr std::array kReasons{ExtraReason::not_finite, ExtraReason::zero_range,
                                ExtraReason::collision,  ExtraReason::stray,
                                ExtraReason::not_finite, ExtraReason::stray};
  constexpr std::array<std::uint32_t, 6> kPoints{1, 2, 3, 4, 5, 6};
  for (std::size_t i = 0; i < kReasons.size(); ++i) {
    EXPECT_EQ(image.extras[i].point, kPoints[i]);
    EXPECT_EQ(image.extras[i].reason, kReasons[i]) << "extra " << i;
  }
}

TEST(BeamGrid, SecondReturnsMakeAnImageOfTheirOwn) {
  const SensorModel model = made_up_model();
  PointCloud cloud;
  for (int tick = 0; tick < 200; tick += 2) {
    push(cloud, point_of(model, 7, tick, 10.0));
    push(cloud, point_of(model, 7, tick, 14.0));
  }
  const BeamImage first = project(model, cloud);
  ASSERT_EQ(first.extras.size(), 100U);
  std::vector<std::uint32_t> rest;
  for (const ExtraPoint& extra : first.extras) rest.push_back(extra.point);
  BeamImage second;
  BeamProjector(model).project(cloud, rest, {}, second);
  EXPECT_TRUE(second.extras.empty());
  EXPECT_EQ(second.firing_tick, first.firing_tick);
  EXPECT_LT(worst_error(model, cloud, second), 0.0001);
  EXPECT_EQ(second.point[static_cast<std::size_t>(7 * second.cols)], 1U);
}

TEST(BeamGrid, ResidualsBringPointsWithinTheBound) {
  std::mt19937 random(2);
  const SensorModel model = made_up_model();
  PointCloud cloud = sweep_of(model, random);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.z[i] += static_cast<float>(test::uniform(random, -0.06, 0.06));
    cloud.x[i] += static_cast<float>(test::uniform(random, -0.04, 0.04));
  }
  BeamGridOptions options;
  EXPECT_GT(worst_error(model, cloud, project(model, cloud, options)), 0.05);
  for (const double bound : {0.05, 0.02, 0.005}) {
    options.max_error_m = bound;
    const BeamImage image = project(model, cloud, options);
    expect_all_there(image, cloud.size());
    EXPECT_EQ(image.height_residual.size(), image.cells());
    EXPECT_LE(worst_error(model, cloud, image), bound + 0.0001) << bound;
  }
}

TEST(BeamGrid, FewMisfitsBecomeExtras) {
  std::mt19937 random(3);
  const SensorModel model = made_up_model();
  PointCloud cloud = sweep_of(model, random);
  cloud.z[77] += 0.04F;
  BeamGridOptions options;
  options.max_error_m = 0.01;
  const BeamImage image = project(model, cloud, options);
  ASSERT_EQ(image.extras.size(), 1U);
  EXPECT_EQ(image.extras[0].point, 77U);
  EXPECT_EQ(image.extras[0].reason, ExtraReason::misfit);
  EXPECT_TRUE(image.height_residual.empty());
  EXPECT_LE(worst_error(model, cloud, image), 0.01);
}

TEST(BeamGrid, GathersJitteringFirings) {
  std::mt19937 random(4);
  SensorModel model = made_up_model();
  model.jitter = 2;
  PointCloud cloud;
  for (int tick = 0; tick + 20 < model.ticks_per_turn; tick += 10) {
    for (std::size_t k = 0; k < 16; ++k) {
      const int off = k % 5 == 0 ? test::uniform_int(random, 0, 2) : 0;
      push(cloud, point_of(model, k, tick + off, 10.0));
    }
  }
  BeamGridOptions options;
  EXPECT_GT(project(model, cloud, options).cols, 300);
  options.max_error_m = 0.01;  // a tick is 31 mm at 10 m
  const BeamImage image = project(model, cloud, options);
  EXPECT_EQ(image.cols, 198);
  EXPECT_TRUE(image.extras.empty());
  EXPECT_EQ(image.azimuth_residual.size(), image.cells());
  EXPECT_LE(worst_error(model, cloud, image), 0.0101);
}

TEST(BeamGrid, ColumnShiftsLookTheSameWay) {
  const SensorModel model = made_up_model();
  std::vector<std::int32_t> firings;
  for (const int tick : test::firings(model)) firings.push_back(tick);
  std::vector<std::int32_t> shift;
  column_shifts(model, firings, shift);
  const auto azimuth = [&](std::size_t k, int column) {
    return (firings[static_cast<std::size_t>(column)] + model.beams[k].lag) * 0.18 +
           model.beams[k].azimuth_offset / 1e6;
  };
  for (std::size_t k = 0; k < 16; ++k) {
    for (std::size_t m = 0; m < 16; ++m) {
      const int other = 600 + shift[k] - shift[m];
      EXPECT_NEAR(azimuth(k, 600), azimuth(m, other), 0.6) << k << " " << m;
    }
  }
}

TEST(BeamGrid, AnyModelWithinBoundsIsSafe) {
  std::mt19937 random(5);
  for (int round = 0; round < 200; ++round) {
    SensorModel model;
    model.ticks_per_turn = test::uniform_int(random, 1, 5000);
    model.jitter = test::uniform_int(random, 0, model.ticks_per_turn / 2);
    for (int k = test::uniform_int(random, 1, 40); k > 0; --k) {
      model.beams.push_back(
          {test::uniform_int(random, -100, 100) * kTangentUnits,
           test::uniform_int(random, -1'000'000, 1'000'000),
           test::uniform_int(random, -360'000'000, 360'000'000),
           test::uniform_int(random, -1'000'000, 1'000'000),
           test::uniform_int(random, -model.ticks_per_turn, model.ticks_per_turn)});
    }
    std::sort(model.beams.begin(), model.beams.end(),
              [](const Beam& a, const Beam& b) { return a.tan_elevation > b.tan_elevation; });
    ASSERT_TRUE(check(model));
    PointCloud cloud;
    for (int i = 0; i < 200; ++i) {
      const double size = std::pow(10.0, test::uniform(random, -6, 8));
      push(cloud, {test::uniform(random, -size, size), test::uniform(random, -size, size),
                   test::uniform(random, -size, size)});
    }
    BeamGridOptions options;
    options.max_error_m = round % 2 == 0 ? 0.0 : 0.02;
    const BeamImage image = project(model, cloud, options);
    expect_all_there(image, cloud.size());
    for (const float x : unproject(model, image).x) ASSERT_TRUE(std::isfinite(x));
  }
}

TEST(BeamGrid, RawKittiSweepsHaveACellForEveryPoint) {
  const auto paths = lab::real_sweeps("kitti_hdl64");
  if (paths.empty()) GTEST_SKIP() << "needs SWEEPCAST_DATA";
  std::vector<PointCloud> clouds;
  clouds.reserve(paths.size());
  for (const auto& path : paths) clouds.push_back(lab::read_kitti(path));
  const std::vector<CloudView> views(clouds.begin(), clouds.end());
  const auto estimate = estimate_sensor_model(views);
  ASSERT_TRUE(estimate) << estimate.error().message;
  EXPECT_EQ(estimate->model.beams.size(), 64U);
  EXPECT_EQ(estimate->model.ticks_per_turn, 4000);
  for (const PointCloud& cloud : clouds) {
    const BeamImage image = project(estimate->model, cloud);
    expect_all_there(image, cloud.size());
    EXPECT_LE(image.extras.size(), 2U);
    EXPECT_LT(image.cols, 2170);
    EXPECT_LT(worst_error(estimate->model, cloud, image), 0.0015);
  }
}

}  // namespace
}  // namespace sweepcast
