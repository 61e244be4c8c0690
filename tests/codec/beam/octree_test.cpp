// Lattice points as an octree and back.
#include "codec/beam/octree.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/random.hpp"

namespace sweepcast::beam {
namespace {

using test::random_bits;
using test::uniform_int;

constexpr int kMost = kLatticeLimit - 1;

/// Sorts the points and writes them.
std::vector<std::byte> bytes_of(std::vector<LatticePoint>& points) {
  std::vector<std::uint32_t> order(points.size());
  sort_for_octree(points, order);
  std::vector<std::byte> bytes;
  write_octree(points, bytes);
  return bytes;
}

/// Writes, reads, and compares as multisets; gives the size in bytes.
std::size_t expect_round_trip(const std::vector<LatticePoint>& points) {
  std::vector<LatticePoint> in_order = points;
  const std::vector<std::byte> bytes = bytes_of(in_order);
  std::vector<LatticePoint> back(points.size());
  EXPECT_TRUE(read_octree(bytes, back));
  EXPECT_EQ(back, in_order);
  std::vector<LatticePoint> sorted = points;
  std::sort(sorted.begin(), sorted.end());
  std::sort(back.begin(), back.end());
  EXPECT_EQ(back, sorted);
  return bytes.size();
}

std::vector<LatticePoint> random_points(std::mt19937& random, std::size_t count, int reach) {
  std::vector<LatticePoint> points(count);
  for (LatticePoint& point : points) {
    for (std::int32_t& coordinate : point) coordinate = uniform_int(random, -reach, reach);
  }
  return points;
}

TEST(Octree, RandomPointsComeBack) {
  std::mt19937 random(1);
  for (const int reach : {0, 1, 7, 300, 70'000, kMost}) {
    for (const std::size_t count : {1U, 2U, 3U, 50U, 5000U}) {
      SCOPED_TRACE(std::to_string(count) + " points within " + std::to_string(reach));
      expect_round_trip(random_points(random, count, reach));
    }
  }
}

TEST(Octree, CornersOfTheLatticeComeBack) {
  std::vector<LatticePoint> corners;
  for (int corner = 0; corner < 8; ++corner) {
    corners.push_back({(corner & 4) != 0 ? kMost : -kMost, (corner & 2) != 0 ? kMost : -kMost,
                       (corner & 1) != 0 ? kMost : -kMost});
    expect_round_trip({corners.back()});
  }
  corners.push_back({0, 0, 0});
  corners.push_back({-1, 0, 0});
  expect_round_trip(corners);
}

TEST(Octree, DuplicatesComeBack) {
  std::mt19937 random(2);
  std::vector<LatticePoint> points = random_points(random, 200, 5000);
  for (int i = 0; i < 3000; ++i) points.push_back(points[random_bits(random) % 200]);
  expect_round_trip(points);
  expect_round_trip(std::vector<LatticePoint>(10'000, {12, -345, 678}));
}

TEST(Octree, NoPointsNeedNoBytes) {
  EXPECT_EQ(expect_round_trip({}), 0U);
}

TEST(Octree, APlaneCostsLessThanAVolume) {
  std::mt19937 random(3);
  std::vector<LatticePoint> plane = random_points(random, 4000, 511);
  const std::size_t volume = expect_round_trip(plane);
  // Points of a set need no order: log2(4000!) / 8 bytes less than 30 bits each, 9850 of 15000.
  EXPECT_LT(volume, 10'400U);
  for (LatticePoint& point : plane) point[2] = 17;
  EXPECT_LT(expect_round_trip(plane), 6'000U);
}

TEST(Octree, CutBytesAreRefusedOrGiveOtherPoints) {
  std::mt19937 random(4);
  std::vector<LatticePoint> points = random_points(random, 500, 100'000);
  const std::vector<std::byte> bytes = bytes_of(points);
  std::size_t refused = 0;
  for (std::size_t size = 0; size + 5 < bytes.size(); size += 13) {
    std::vector<LatticePoint> back(points.size());
    if (read_octree(std::span<const std::byte>(bytes).first(size), back)) {
      EXPECT_NE(back, points) << size;
    } else {
      ++refused;
    }
  }
  EXPECT_GT(refused, bytes.size() / 13 / 2);
}

TEST(Octree, RandomBytesGivePointsWithinTheLattice) {
  std::mt19937 random(5);
  for (int i = 0; i < 500; ++i) {
    std::vector<std::byte> bytes(static_cast<std::size_t>(uniform_int(random, 0, 400)));
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random_bits(random));
    std::vector<LatticePoint> back(static_cast<std::size_t>(uniform_int(random, 0, 400)));
    if (!read_octree(bytes, back)) continue;
    for (const LatticePoint& point : back) {
      for (const std::int32_t coordinate : point) {
        EXPECT_TRUE(coordinate >= -kLatticeLimit && coordinate <= kMost);
      }
    }
  }
}

}  // namespace
}  // namespace sweepcast::beam
