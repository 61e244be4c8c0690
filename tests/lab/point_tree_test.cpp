#include "lab/point_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace sweepcast::lab {
namespace {

using Eigen::Vector3d;

/// Squared distances to all points, nearest first, as many as a query gives.
std::vector<double> nearest_squares(const std::vector<Vector3d>& points, const Vector3d& query) {
  std::vector<double> squares;
  squares.reserve(points.size());
  for (const Vector3d& point : points) squares.push_back((point - query).squaredNorm());
  std::sort(squares.begin(), squares.end());
  squares.resize(std::min(squares.size(), PointTree::kMostNeighbours));
  return squares;
}

std::vector<double> found_squares(const std::vector<Vector3d>& points, const PointTree& tree,
                                  const Vector3d& query) {
  std::array<std::uint32_t, PointTree::kMostNeighbours> indices{};
  std::vector<double> squares;
  for (const std::uint32_t i : tree.nearest(query, indices)) {
    squares.push_back((points[i] - query).squaredNorm());
  }
  return squares;
}

TEST(PointTree, AgreesWithBruteForceWherePointsAreThereSeveralTimes) {
  std::mt19937 random(4);
  std::vector<Vector3d> points;
  // Few places, so that some have more points than a query gives, and some just one.
  for (int i = 0; i < 600; ++i) {
    const auto step = [&] { return 0.25 * static_cast<double>(random() % (i < 300 ? 3 : 9)); };
    const double x = step();
    const double y = step();
    points.emplace_back(x, y, step());
  }
  const PointTree tree(points);
  std::uniform_real_distribution<double> coordinate(-0.5, 2.5);
  for (int i = 0; i < 200; ++i) {
    const double x = coordinate(random);
    const double y = coordinate(random);
    const Vector3d query(x, y, coordinate(random));
    EXPECT_EQ(found_squares(points, tree, query), nearest_squares(points, query));
    EXPECT_EQ((points[tree.nearest(query)] - query).squaredNorm(),
              nearest_squares(points, query).front());
  }
}

/// A query visits all points of a leaf, and a leaf of equal points cannot be split.
TEST(PointTree, HoldsEqualPointsOnce) {
  std::vector<Vector3d> points(20'000, Vector3d(1, 2, 3));
  points.emplace_back(1, 2, 4);
  points.emplace_back(-0.0, 2, 3);
  points.emplace_back(0.0, 2, 3);
  const PointTree tree(points);
  EXPECT_EQ(tree.kdtree_get_point_count(), 3U);
  std::array<std::uint32_t, 12> indices{};
  const auto found = tree.nearest(Vector3d(1, 2, 3.1), indices);
  EXPECT_EQ(std::vector(found.begin(), found.end()), std::vector<std::uint32_t>(12, 0));
  EXPECT_EQ(tree.nearest(Vector3d(0, 2, 3)), 20'001U);
}

TEST(PointTree, GivesFewerWhereThereAreFewer) {
  const std::vector<Vector3d> points{{5, 0, 0}, {1, 0, 0}, {5, 0, 0}};
  const PointTree tree(points);
  std::array<std::uint32_t, 12> indices{};
  const auto found = tree.nearest(Vector3d(0, 0, 0), indices);
  EXPECT_EQ(std::vector(found.begin(), found.end()), (std::vector<std::uint32_t>{1, 0, 0}));
}

}  // namespace
}  // namespace sweepcast::lab
