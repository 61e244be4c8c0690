// Distances between surfaces, against what geometry says.
#include "lab/mesh/mesh_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sweepcast::lab {
namespace {

// A rectangle of `length` by `width` metres at height z, cut into `pieces` strips along x.
TriangleMesh plate(float length, float width, float z, int pieces = 1) {
  TriangleMesh mesh;
  for (int i = 0; i <= pieces; ++i) {
    const float x = length * static_cast<float>(i) / static_cast<float>(pieces);
    mesh.vertices.emplace_back(x, 0.0F, z);
    mesh.vertices.emplace_back(x, width, z);
  }
  for (std::uint32_t i = 0; i < 2 * static_cast<std::uint32_t>(pieces); i += 2) {
    mesh.triangles.push_back({i, i + 2, i + 3});
    mesh.triangles.push_back({i, i + 3, i + 1});
  }
  return mesh;
}

TEST(SampleSurface, IsEvenOverTheAreaHoweverItIsCut) {
  for (const int pieces : {1, 7, 1000}) {
    const TriangleMesh mesh = plate(10.0F, 4.0F, 1.0F, pieces);
    EXPECT_NEAR(surface_area(mesh), 40.0, 1e-3);
    const auto samples = sample_surface(mesh, 50.0);
    EXPECT_NEAR(static_cast<double>(samples.size()), 2000.0, 1.0);
    std::array<int, 10> in_cell{};  // of 2 x 2 m; 200 are due in each
    for (const SurfaceSample& sample : samples) {
      EXPECT_FLOAT_EQ(static_cast<float>(sample.place.z()), 1.0F);
      const auto cell = static_cast<std::size_t>(sample.place.x() / 2.0) +
                        5 * static_cast<std::size_t>(sample.place.y() / 2.0);
      ++in_cell.at(std::min<std::size_t>(cell, 9));
    }
    for (const int count : in_cell) EXPECT_NEAR(count, 200, 20) << pieces;
  }
}

TEST(DistanceToTriangle, IsThatOfTheNearestOfManyPlaces) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  const auto draw = [&] {
    return Eigen::Vector3d(coordinate(random), coordinate(random), coordinate(random));
  };
  for (int run = 0; run < 200; ++run) {
    const Eigen::Vector3d a = draw(), b = draw(), c = draw(), point = 2.0 * draw();
    double nearest = 1e9;
    constexpr int kSteps = 60;
    for (int i = 0; i <= kSteps; ++i) {
      for (int k = 0; k + i <= kSteps; ++k) {
        const Eigen::Vector3d place = a + (b - a) * i / kSteps + (c - a) * k / kSteps;
        nearest = std::min(nearest, (place - point).norm());
      }
    }
    const double found = distance_to_triangle(point, a, b, c);
    EXPECT_LE(found, nearest + 1e-9);
    EXPECT_GE(found, nearest - 0.06);
  }
}

TEST(DistanceToTriangle, OfOneWithoutAreaIsThatToItsEdges) {
  const Eigen::Vector3d a(0, 0, 0), b(1, 0, 0), c(3, 0, 0);
  EXPECT_DOUBLE_EQ(distance_to_triangle({2, 1, 0}, a, b, c), 1.0);
  EXPECT_DOUBLE_EQ(distance_to_triangle({0, 0, 2}, a, a, a), 2.0);
}

TEST(MeshError, OfAShiftedPlateIsTheShift) {
  const auto error = mesh_error(plate(10.0F, 10.0F, 0.07F, 50), plate(10.0F, 10.0F, 0.0F));
  ASSERT_TRUE(error) << error.error().message;
  EXPECT_NEAR(error->accuracy_m, 0.07, 1e-4);
  EXPECT_NEAR(error->completeness_m, 0.07, 1e-3);
  ASSERT_EQ(error->scores.size(), 3U);
  EXPECT_EQ(error->scores[0].f_score, 0.0);
  EXPECT_GT(error->scores[1].f_score, 99.9);
}

TEST(MeshError, HalfAPlateIsPreciseAndHalfComplete) {
  const TriangleMesh half = plate(5.0F, 10.0F, 0.0F, 40), whole = plate(10.0F, 10.0F, 0.0F, 40);
  const auto error = mesh_error(half, whole);
  ASSERT_TRUE(error);
  EXPECT_DOUBLE_EQ(error->scores[1].precision, 100.0);
  EXPECT_NEAR(error->scores[1].recall, 51.0, 0.5);  // half, and 10 cm
  EXPECT_NEAR(error->scores[1].f_score, 2.0 * 100.0 * 51.0 / 151.0, 0.5);
  const auto seen =
      mesh_error(half, whole, {}, [](const Eigen::Vector3d& place) { return place.x() < 5.0; });
  ASSERT_TRUE(seen);
  EXPECT_DOUBLE_EQ(seen->scores[1].f_score, 100.0);
}

TEST(MeshError, RefusesWhatHasNoSurface) {
  const TriangleMesh mesh = plate(1.0F, 1.0F, 0.0F);
  EXPECT_EQ(mesh_error(TriangleMesh{}, mesh).error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(mesh_error(mesh, TriangleMesh{}).error().code, ErrorCode::invalid_argument);
  const auto unseen = mesh_error(mesh, mesh, {}, [](const Eigen::Vector3d&) { return false; });
  EXPECT_EQ(unseen.error().code, ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace sweepcast::lab
