#include "lab/distortion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "lab/real_sweeps.hpp"

namespace sweepcast::lab {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

PointCloud cloud_of(const std::vector<std::array<float, 3>>& points) {
  PointCloud cloud;
  for (const auto& [x, y, z] : points) {
    cloud.x.push_back(x);
    cloud.y.push_back(y);
    cloud.z.push_back(z);
  }
  return cloud;
}

/// A level grid of side x side points, one metre apart, at height z; nowhere near the origin.
PointCloud plane(int side, float z) {
  std::vector<std::array<float, 3>> points;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      points.push_back({10.0F + static_cast<float>(i), 10.0F + static_cast<float>(j), z});
    }
  }
  return cloud_of(points);
}

PointCloud random_cloud(std::size_t count, unsigned seed, float size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> coordinate(-size, size);
  std::vector<std::array<float, 3>> points(count);
  for (auto& point : points) {
    for (float& value : point) value = coordinate(random);
  }
  return cloud_of(points);
}

double psnr(double mean_square) {
  return 10.0 * std::log10(3.0 * 59.70 * 59.70 / mean_square);
}

/// One direction by brute force: mean, root mean square, largest distance, and share within tau.
struct OneWay {
  double mean = 0, rms = 0, max = 0;
  std::vector<double> distances;

  OneWay(const PointCloud& from, const PointCloud& to) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t j = 0; j < to.size(); ++j) {
        nearest =
            std::min(nearest, std::hypot(double{from.x[i]} - to.x[j], double{from.y[i]} - to.y[j],
                                         double{from.z[i]} - to.z[j]));
      }
      distances.push_back(nearest);
      mean += nearest;
      rms += nearest * nearest;
      max = std::max(max, nearest);
    }
    mean /= static_cast<double>(from.size());
    rms = std::sqrt(rms / static_cast<double>(from.size()));
  }

  double share(double tau) const {
    return static_cast<double>(std::count_if(distances.begin(), distances.end(),
                                             [tau](double d) { return d <= tau; })) /
           static_cast<double>(distances.size());
  }
};

TEST(Distortion, AgreesWithBruteForceOnRandomClouds) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const PointCloud original = random_cloud(900, seed, 0.5F);
    const PointCloud decoded = random_cloud(std::size_t{400} * seed, seed + 100, 0.5F);
    const Distortion d = compare(original, decoded);
    const OneWay o2d(original, decoded);
    const OneWay d2o(decoded, original);
    EXPECT_NEAR(d.mean_o2d, o2d.mean, 1e-12);
    EXPECT_NEAR(d.rms_o2d, o2d.rms, 1e-12);
    EXPECT_NEAR(d.max_o2d, o2d.max, 1e-12);
    EXPECT_NEAR(d.mean_d2o, d2o.mean, 1e-12);
    EXPECT_NEAR(d.rms_d2o, d2o.rms, 1e-12);
    EXPECT_NEAR(d.max_d2o, d2o.max, 1e-12);
    EXPECT_NEAR(d.d1_psnr, psnr(std::pow(std::max(o2d.rms, d2o.rms), 2)), 1e-9);
    EXPECT_GT(d.d2_psnr, d.d1_psnr);
    for (std::size_t k = 0; k < kFScoreDistancesM.size(); ++k) {
      const double precision = d2o.share(kFScoreDistancesM[k]);
      const double recall = o2d.share(kFScoreDistancesM[k]);
      EXPECT_NEAR(d.f_score[k], 200.0 * precision * recall / (precision + recall), 1e-9);
    }
  }
}

TEST(Distortion, SwappingTheCloudsSwapsTheDirections) {
  const PointCloud a = random_cloud(500, 7, 1.0F);
  const PointCloud b = random_cloud(300, 8, 1.0F);
  const Distortion ab = compare(a, b);
  const Distortion ba = compare(b, a);
  EXPECT_DOUBLE_EQ(ab.mean_o2d, ba.mean_d2o);
  EXPECT_DOUBLE_EQ(ab.rms_d2o, ba.rms_o2d);
  EXPECT_DOUBLE_EQ(ab.max_o2d, ba.max_d2o);
  EXPECT_DOUBLE_EQ(ab.d1_psnr, ba.d1_psnr);
  EXPECT_EQ(ab.f_score, ba.f_score);
}

TEST(Distortion, OfAPlaneShiftedAlongItsNormalIsTheShift) {
  const Distortion d = compare(plane(20, 1.0F), plane(20, 1.0625F));
  EXPECT_DOUBLE_EQ(d.mean_o2d, 0.0625);
  EXPECT_DOUBLE_EQ(d.rms_d2o, 0.0625);
  EXPECT_DOUBLE_EQ(d.max_d2o, 0.0625);
  EXPECT_NEAR(d.d1_psnr, psnr(0.0625 * 0.0625), 1e-9);
  EXPECT_NEAR(d.d2_psnr, psnr(0.0625 * 0.0625), 1e-6);
  EXPECT_EQ(d.f_score, (std::array<double, 4>{0, 0, 100, 100}));
  EXPECT_EQ(d.mean_azimuth_error_deg, 0.0);
  EXPECT_GT(d.mean_elevation_error_deg, 0.1);
}

TEST(Distortion, AlongAPlaneIsFreeOfPointToPlaneError) {
  PointCloud shifted = plane(20, 1.0F);
  for (float& x : shifted.x) x += 0.125F;
  const Distortion d = compare(plane(20, 1.0F), shifted);
  EXPECT_NEAR(d.d1_psnr, psnr(0.125 * 0.125), 1e-9);
  EXPECT_GT(d.d2_psnr, 200.0);  // nothing but the normals' rounding
}

TEST(Distortion, PointToPlaneTakesTheWorseDirection) {
  // The decoded cloud has one point more, 3 m above the plane: only d2o sees it.
  PointCloud decoded = plane(20, 1.0F);
  decoded.x.push_back(15.0F);
  decoded.y.push_back(15.0F);
  decoded.z.push_back(4.0F);
  const Distortion d = compare(plane(20, 1.0F), decoded);
  EXPECT_EQ(d.mean_o2d, 0.0);
  EXPECT_DOUBLE_EQ(d.max_d2o, 3.0);
  EXPECT_NEAR(d.d1_psnr, psnr(9.0 / 401), 1e-9);
  EXPECT_NEAR(d.d2_psnr, psnr(9.0 / 401), 1e-6);
  EXPECT_NEAR(d.f_score[0], 100.0 * 2 * (400.0 / 401) / (400.0 / 401 + 1), 1e-9);
}

TEST(Distortion, ADistanceOfExactlyTauCounts) {
  struct Point {
    double x, y, z;
  };
  const auto view = [](const std::vector<Point>& points) {
    return CloudView::structs<Point>(points, &Point::x, &Point::y, &Point::z);
  };
  const std::vector<Point> original{{5.0, 0.0, 0.0}};
  const std::vector<Point> at_tau{{5.0, 0.05, 0.0}};
  const std::vector<Point> beyond{{5.0, std::nextafter(0.05, 1.0), 0.0}};
  EXPECT_EQ(compare(view(original), view(at_tau)).f_score[1], 100.0);
  EXPECT_EQ(compare(view(original), view(beyond)).f_score[1], 0.0);
}

TEST(Distortion, AngularErrorsAreSignedAndWrap) {
  const auto polar = [](double azimuth_deg, double elevation_deg) {
    const double a = azimuth_deg * std::numbers::pi / 180;
    const double e = elevation_deg * std::numbers::pi / 180;
    return std::array<float, 3>{static_cast<float>(20 * std::cos(e) * std::cos(a)),
                                static_cast<float>(20 * std::cos(e) * std::sin(a)),
                                static_cast<float>(20 * std::sin(e))};
  };
  const auto original = cloud_of({polar(179.9, 1.0), polar(90.0, -2.0)});
  const auto decoded = cloud_of({polar(-179.9, 0.9), polar(90.1, -2.1)});
  const Distortion d = compare(original, decoded);
  EXPECT_NEAR(d.mean_azimuth_error_deg, 0.15, 1e-4);
  EXPECT_NEAR(d.mean_elevation_error_deg, -0.1, 1e-4);
}

TEST(Distortion, LeavesOutAndCountsWhatIsNoPoint) {
  PointCloud original = plane(5, 1.0F);
  PointCloud decoded = original;
  for (const auto& [x, y, z] : std::vector<std::array<float, 3>>{
           {kNan, 1, 1}, {1, kInfinity, 1}, {1, 1, -kInfinity}, {0, 0, 0}}) {
    original.x.push_back(x);
    original.y.push_back(y);
    original.z.push_back(z);
  }
  decoded.x.push_back(0);
  decoded.y.push_back(-0.0F);
  decoded.z.push_back(0);
  const Distortion d = compare(original, decoded);
  EXPECT_EQ(d.points_original, 29);
  EXPECT_EQ(d.left_out_original, 4);
  EXPECT_EQ(d.points_decoded, 26);
  EXPECT_EQ(d.left_out_decoded, 1);
  EXPECT_EQ(d.max_o2d, 0.0);
  EXPECT_EQ(d.max_d2o, 0.0);
}

TEST(Distortion, OfEqualCloudsIsNoneAndPsnrInfinite) {
  const PointCloud cloud = random_cloud(200, 5, 20.0F);
  const Distortion d = compare(cloud, cloud);
  EXPECT_EQ(d.rms_o2d, 0.0);
  EXPECT_EQ(d.d1_psnr, std::numeric_limits<double>::infinity());
  EXPECT_EQ(d.d2_psnr, std::numeric_limits<double>::infinity());
  EXPECT_EQ(d.f_score, (std::array<double, 4>{100, 100, 100, 100}));
}

TEST(Distortion, OfEmptyCloudsIsDefined) {
  const PointCloud none;
  const PointCloud some = plane(3, 1.0F);
  const Distortion both = compare(none, none);
  EXPECT_EQ(both.mean_o2d, 0.0);
  EXPECT_EQ(both.f_score[0], 100.0);
  EXPECT_EQ(both.d1_psnr, std::numeric_limits<double>::infinity());
  for (const Distortion& d : {compare(some, none), compare(none, some)}) {
    EXPECT_TRUE(std::isnan(d.mean_o2d));
    EXPECT_TRUE(std::isnan(d.d1_psnr));
    EXPECT_TRUE(std::isnan(d.mean_azimuth_error_deg));
    EXPECT_EQ(d.f_score[3], 0.0);
  }
}

TEST(Distortion, WithoutNormalsIsPointToPoint) {
  const Distortion d = compare(cloud_of({{1, 0, 0}, {9, 0, 0}}), cloud_of({{1, 0, 2}, {9, 0, 2}}));
  EXPECT_DOUBLE_EQ(d.d2_psnr, d.d1_psnr);
}

TEST(Distortion, OfManyEqualPointsIsDefined) {
  const PointCloud same = cloud_of(std::vector<std::array<float, 3>>(5000, {1.0F, 2.0F, 3.0F}));
  const Distortion d = compare(same, cloud_of({{1.0F, 2.0F, 3.5F}}));
  EXPECT_DOUBLE_EQ(d.mean_o2d, 0.5);
  EXPECT_TRUE(std::isfinite(d.d1_psnr));
  EXPECT_FALSE(std::isnan(d.d2_psnr));
}

TEST(Distortion, MeanIsTakenFigureByFigure) {
  DistortionMean mean;
  mean.add(compare(plane(4, 1.0F), plane(4, 1.25F)));
  mean.add(compare(plane(8, 1.0F), plane(8, 1.75F)));
  EXPECT_DOUBLE_EQ(mean.mean().mean_o2d, 0.5);
  EXPECT_DOUBLE_EQ(mean.mean().points_original, 40);
  EXPECT_DOUBLE_EQ(mean.mean().d1_psnr, (psnr(0.0625) + psnr(0.5625)) / 2);
}

/// Known by another route: coordinates rounded to multiples of 0.1 m, measured by other software.
TEST(Distortion, OfRealSweepsOnAGridIsTheKnownOne) {
  const auto sweeps = real_sweeps("kitti_hdl64");
  if (sweeps.empty()) GTEST_SKIP() << "set SWEEPCAST_DATA to a folder with kitti_hdl64";
  DistortionMean means;
  for (const auto& path : sweeps) {
    const PointCloud original = read_kitti(path);
    PointCloud decoded = original;
    for (auto* column : {&decoded.x, &decoded.y, &decoded.z}) {
      for (float& value : *column) value = std::round(value / 0.1F) * 0.1F;
    }
    means.add(compare(original, decoded));
  }
  const Distortion mean = means.mean();
  EXPECT_NEAR(mean.points_original, 122598, 1);
  EXPECT_NEAR(mean.mean_o2d, 0.0480, 0.0001);
  EXPECT_NEAR(mean.rms_o2d, 0.0500, 0.0001);
  EXPECT_NEAR(mean.rms_d2o, 0.0409, 0.0001);
  EXPECT_NEAR(mean.d1_psnr, 66.31, 0.01);
  EXPECT_NEAR(mean.d2_psnr, 71.09, 0.02);
  EXPECT_NEAR(mean.f_score[0], 5.31, 0.05);
  EXPECT_NEAR(mean.f_score[1], 62.43, 0.2);
  EXPECT_EQ(mean.f_score[2], 100.0);
  EXPECT_EQ(mean.f_score[3], 100.0);
}

}  // namespace
}  // namespace sweepcast::lab
