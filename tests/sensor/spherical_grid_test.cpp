#include "sensor/spherical_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/random.hpp"
#include "sensor/slow_grid.hpp"

namespace sweepcast {
namespace {

using test::add_point;
using test::add_polar;
using test::Polar;
using test::polar_of;
using test::SlowGrid;
using test::sum_without_input;
using test::uniform;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Projected {
  RangeImage image;
  SweepCounts counts;
};

Projected project(const PointCloud& cloud, const RcpccOptions& options, const Crop& crop = {}) {
  Projected p;
  SphericalProjector(options, crop).project(cloud, p.image, p.counts);
  return p;
}

std::size_t occupied(const RangeImage& image) {
  return image.range_mm.size() -
         static_cast<std::size_t>(std::count(image.range_mm.begin(), image.range_mm.end(), 0));
}

/// A random cloud of points that lie clearly on one side of every limit, so that float and double
/// must agree on the cell.
PointCloud clear_cut_cloud(std::mt19937& random, const RcpccOptions& o, std::size_t count) {
  PointCloud cloud;
  while (cloud.size() < count) {
    PointCloud one;
    add_polar(one, uniform(random, -180, 180), uniform(random, -60, 40),
              std::pow(10.0, uniform(random, -2, 2.9)));
    const Polar p = polar_of(one, 0);
    const auto near_edge = [](double steps) { return std::abs(steps - std::round(steps)) < 0.004; };
    if (near_edge((p.azimuth - o.azimuth_min_deg) / o.params.azimuth_step_deg) ||
        near_edge((p.azimuth - o.azimuth_min_deg + 360) / o.params.azimuth_step_deg) ||
        near_edge((p.elevation - o.elevation_min_deg) / o.params.elevation_step_deg) ||
        std::abs(p.range - o.max_range_m) < 1e-3) {
      continue;
    }
    add_point(cloud, double{one.x[0]}, double{one.y[0]}, double{one.z[0]});
    // Crowds, so that cells have several points.
    if (random() % 2 == 0) add_point(cloud, one.x[0] * 1.5, one.y[0] * 1.5, one.z[0] * 1.5);
  }
  return cloud;
}

void expect_agrees(const PointCloud& cloud, const RcpccOptions& o, const Crop& crop) {
  const SlowGrid slow(cloud, o, crop);
  const Projected fast = project(cloud, o, crop);
  EXPECT_EQ(fast.counts, slow.counts);
  EXPECT_EQ(sum_without_input(fast.counts), fast.counts.points_in);
  EXPECT_EQ(occupied(fast.image), slow.cells.size());
  ASSERT_FALSE(slow.cells.empty());
  const SphericalGrid& grid = fast.image.grid;
  const int low = slow.cells.begin()->first.first;
  EXPECT_NEAR(grid.elevation_min * 1e-6, o.elevation_min_deg + low * o.params.elevation_step_deg,
              1e-6 * grid.rows);
  EXPECT_EQ(grid.rows, slow.cells.rbegin()->first.first - low + 1);
  for (const auto& [cell, candidates] : slow.cells) {
    const std::int32_t got = fast.image.row(cell.first - low)[cell.second];
    const auto key = [&](const SlowGrid::Candidate& c) {
      return o.collision == CollisionRule::nearest_range ? c.range : c.off_centre;
    };
    double best = std::numeric_limits<double>::infinity();
    for (const auto& c : candidates) best = std::min(best, key(c));
    // The winner is told by its range; angles are compared in 1/256 step.
    const bool good = std::any_of(candidates.begin(), candidates.end(), [&](const auto& c) {
      return std::abs(c.range * 1000 - got) <= 0.6 && key(c) <= best + 0.008;
    });
    EXPECT_TRUE(good) << "row " << cell.first << ", column " << cell.second << ": " << got;
  }
}

TEST(SphericalGrid, AgreesWithASlowReference) {
  std::mt19937 random(1);
  const std::array<RcpccParams, 4> steps{
      {{0.5, 0.5, 0.3, 0.2}, {2, 1, 0.3, 0.2}, {0.7, 0.35, 0.3, 0.2}, {0.2, 3, 0.3, 0.2}}};
  for (const RcpccParams& params : steps) {
    for (const auto rule : {CollisionRule::nearest_centre, CollisionRule::nearest_range}) {
      RcpccOptions options;
      options.params = params;
      options.collision = rule;
      expect_agrees(clear_cut_cloud(random, options, 20000), options, {});
      options.elevation_min_deg = -24.9;
      options.elevation_max_deg = 2.3;
      options.max_range_m = 120;
      options.azimuth_min_deg = 131.25;  // across the seam
      options.azimuth_max_deg = -40;
      expect_agrees(clear_cut_cloud(random, options, 20000), options, {});
      options.azimuth_min_deg = -90;
      options.azimuth_max_deg = 45;
      expect_agrees(clear_cut_cloud(random, options, 20000), options, {});
    }
  }
}

TEST(SphericalGrid, CropsByRangeBoxAndRobot) {
  std::mt19937 random(2);
  const RcpccOptions options;
  const PointCloud cloud = clear_cut_cloud(random, options, 20000);
  Crop crop;
  crop.min_range = 1.0F;
  expect_agrees(cloud, options, crop);
  crop.max_range = 90.0F;
  expect_agrees(cloud, options, crop);
  crop.keep = Box{-30, -20, -10, 40, 50, 5};
  expect_agrees(cloud, options, crop);
  crop.robot = Box{-2, -1, -2, 3, 1, 1};
  expect_agrees(cloud, options, crop);
  EXPECT_GT(project(cloud, options, crop).counts.cropped, 5000U);
}

TEST(SphericalGrid, BothCornersBelongToABox) {
  PointCloud cloud;
  add_point(cloud, 1, 2, 3);
  add_point(cloud, -1, -2, -3);
  Crop crop;
  crop.keep = Box{-1, -2, -3, 1, 2, 3};
  EXPECT_EQ(project(cloud, {}, crop).counts.points_coded, 2U);
  crop.robot = crop.keep;
  EXPECT_EQ(project(cloud, {}, crop).counts.cropped, 2U);
}

TEST(SphericalGrid, CountsEveryPointOnce) {
  std::mt19937 random(3);
  SphericalUnprojector unprojector;
  for (int round = 0; round < 20; ++round) {
    PointCloud cloud;
    const auto coordinate = [&]() -> double {
      switch (random() % 24) {
        case 0:
          return kNan;
        case 1:
          return random() % 2 == 0 ? kInfinity : -kInfinity;
        case 2:
          return std::numeric_limits<float>::max();
        case 3:
          return 1e20;  // whose square is infinite
        case 4:
          return std::numeric_limits<float>::denorm_min();
        case 5:
        case 6:
        case 7:
        case 8:
          return 0.0;
        default:
          return uniform(random, -1, 1) * std::pow(10.0, uniform(random, -4, 4));
      }
    };
    for (int i = 0; i < 5000; ++i) {
      add_point(cloud, coordinate(), coordinate(), coordinate());
      if (i % 7 == 0) add_point(cloud, cloud.x.back(), cloud.y.back(), cloud.z.back());
    }
    RcpccOptions options;
    options.elevation_min_deg = -45;
    const Projected p = project(cloud, options);
    EXPECT_EQ(p.counts.points_in, cloud.size());
    EXPECT_EQ(sum_without_input(p.counts), p.counts.points_in);
    EXPECT_EQ(occupied(p.image), p.counts.points_coded);
    EXPECT_GT(p.counts.not_finite, 0U);
    EXPECT_GT(p.counts.zero_range, 0U);
    EXPECT_GT(p.counts.out_of_view, 0U);
    EXPECT_GT(p.counts.collided, 0U);
    PointCloud back;
    unprojector.unproject(p.image, back);
    EXPECT_EQ(back.size(), p.counts.points_coded);
  }
}

TEST(SphericalGrid, NamesTheReasonOfEveryLoss) {
  PointCloud cloud;
  add_point(cloud, kNan, 1, 1);
  add_point(cloud, 1, kInfinity, 1);
  add_point(cloud, 1, 1, -kInfinity);
  add_point(cloud, 0, 0, 0);
  add_point(cloud, 0.0003, -0.0003, 0);  // rounds to 0 mm
  add_point(cloud, 501, 0, 0);
  add_point(cloud, 1e30, 0, 0);
  add_point(cloud, 10, 0.01, 0.01);
  add_point(cloud, 10, 0.01, 0.01);
  const SweepCounts counts = project(cloud, {}).counts;
  EXPECT_EQ(counts.not_finite, 3U);
  EXPECT_EQ(counts.zero_range, 2U);
  EXPECT_EQ(counts.out_of_view, 2U);
  EXPECT_EQ(counts.collided, 1U);
  EXPECT_EQ(counts.points_coded, 1U);
}

TEST(SphericalGrid, WholeSphereHasNoBlindSpot) {
  PointCloud cloud;
  add_point(cloud, 0, 0, 5);
  add_point(cloud, 0, 0, -5);
  add_point(cloud, -5, 0, 0);  // azimuth exactly pi
  add_point(cloud, -5, -0.0, 0);
  add_point(cloud, -5, -1e-30, 0);
  for (const double step : {0.05, 0.3, 0.5, 0.7, 1.0, 7.0, 10.0}) {
    RcpccOptions options;
    options.params.azimuth_step_deg = step;
    options.params.elevation_step_deg = std::max(step, 0.2);
    const SweepCounts counts = project(cloud, options).counts;
    EXPECT_EQ(counts.out_of_view, 0U) << step;
    EXPECT_GE(counts.points_coded, 3U) << step;
  }
}

TEST(SphericalGrid, AViewFromTheSeamToTheSeamIsAFullTurn) {
  RcpccOptions options;
  options.azimuth_min_deg = 180;
  options.azimuth_max_deg = -180;
  PointCloud cloud;
  for (int azimuth = -179; azimuth < 180; azimuth += 2) add_polar(cloud, azimuth + 0.25, 1, 10);
  const Projected p = project(cloud, options);
  EXPECT_EQ(p.image.grid.cols, 720);
  EXPECT_EQ(p.counts.points_coded, cloud.size());
}

TEST(SphericalGrid, OfNothingHasNoRows) {
  const Projected p = project({}, {});
  EXPECT_EQ(p.counts, SweepCounts{});
  EXPECT_EQ(p.image.grid.rows, 0);
  PointCloud cloud;
  add_point(cloud, 1, 2, 3);
  SphericalUnprojector().unproject(p.image, cloud);
  EXPECT_TRUE(cloud.empty());
}

TEST(SphericalGrid, OfEquallyNearPointsTheShorterRangeWins) {
  for (const bool near_first : {true, false}) {
    PointCloud cloud;
    add_point(cloud, near_first ? 4.0 : 16.0, near_first ? 0.015625 : 0.0625, 0);
    add_point(cloud, near_first ? 16.0 : 4.0, near_first ? 0.0625 : 0.015625, 0);
    const Projected p = project(cloud, {});
    EXPECT_EQ(p.counts.collided, 1U);
    EXPECT_EQ(*std::max_element(p.image.range_mm.begin(), p.image.range_mm.end()), 4000);
  }
}

TEST(SphericalGrid, ALonePointComesBackWhereItWas) {
  // Wherever in its cell: the row's offset says where, in 1/256 of a step.
  const double step = 0.5;
  for (int place = 0; place < 1024; ++place) {
    PointCloud cloud;
    add_polar(cloud, 20.0 + step * (place + 0.5) / 1024, -5.0 + step * (1023.5 - place) / 1024, 10);
    const Projected p = project(cloud, {});
    PointCloud back;
    SphericalUnprojector().unproject(p.image, back);
    ASSERT_EQ(back.size(), 1U);
    const Polar was = polar_of(cloud, 0);
    const Polar is = polar_of(back, 0);
    EXPECT_NEAR(is.azimuth, was.azimuth, step / 128) << "place " << place;
    EXPECT_NEAR(is.elevation, was.elevation, step / 128) << "place " << place;
    EXPECT_NEAR(is.range, was.range, 0.00051);
  }
}

/// One point in every cell of a band, anywhere in it.
PointCloud one_point_a_cell(std::mt19937& random, double step, double spread) {
  PointCloud cloud;
  const int rows = static_cast<int>(20 / step);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < static_cast<int>(360 / step); ++col) {
      add_polar(cloud, -180 + step * (col + 0.5 + spread * uniform(random, -0.5, 0.5)),
                -10 + step * (row + 0.5 + spread * uniform(random, -0.5, 0.5)),
                uniform(random, 2, 80));
    }
  }
  return cloud;
}

TEST(SphericalGrid, PointsComeBackWithinTheirCellsInOrder) {
  std::mt19937 random(5);
  for (const double step : {0.25, 0.5, 2.0}) {
    RcpccOptions options;
    options.params.azimuth_step_deg = options.params.elevation_step_deg = step;
    const PointCloud cloud = one_point_a_cell(random, step, 0.98);
    const Projected p = project(cloud, options);
    EXPECT_EQ(p.counts.points_coded, cloud.size());
    PointCloud back;
    SphericalUnprojector().unproject(p.image, back);
    ASSERT_EQ(back.size(), cloud.size());
    double azimuth = 0;
    double elevation = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const Polar was = polar_of(cloud, i);
      const Polar is = polar_of(back, i);
      // Half a step, and what the row's mean is off the centre by chance.
      ASSERT_NEAR(is.azimuth, was.azimuth, 0.62 * step);
      ASSERT_NEAR(is.elevation, was.elevation, 0.62 * step);
      ASSERT_NEAR(is.range, was.range, 0.00052);
      azimuth += is.azimuth - was.azimuth;
      elevation += is.elevation - was.elevation;
    }
    EXPECT_LT(std::abs(azimuth / static_cast<double>(cloud.size())), step / 256);
    EXPECT_LT(std::abs(elevation / static_cast<double>(cloud.size())), step / 256);
  }
}

TEST(SphericalGrid, MeanAnglesOfDenseRingsAreUnbiased) {
  // 64 beams that do not lie at the cells' centres, 2083 firings: several points a cell.
  std::mt19937 random(6);
  PointCloud cloud;
  for (int beam = 0; beam < 64; ++beam) {
    for (int firing = 0; firing < 2083; ++firing) {
      add_polar(cloud, -180 + (firing + 0.37) * 360.0 / 2083, -24.3 + 0.417 * beam,
                15 + uniform(random, -0.02, 0.02));
    }
  }
  const Projected p = project(cloud, {});
  PointCloud back;
  SphericalUnprojector().unproject(p.image, back);
  ASSERT_EQ(back.size(), p.counts.points_coded);
  double azimuth = 0;
  double elevation = 0;
  for (std::size_t i = 0; i < back.size(); ++i) {  // against the nearest beam and firing
    const Polar is = polar_of(back, i);
    const double firing = (is.azimuth + 180) * 2083 / 360 - 0.37;
    azimuth += (firing - std::round(firing)) * 360 / 2083;
    const double beam = (is.elevation + 24.3) / 0.417;
    elevation += (beam - std::round(beam)) * 0.417;
  }
  EXPECT_LT(std::abs(azimuth / static_cast<double>(back.size())), 0.01);
  EXPECT_LT(std::abs(elevation / static_cast<double>(back.size())), 0.01);
}

}  // namespace
}  // namespace sweepcast
