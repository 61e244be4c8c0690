// Finding an octree's nodes, also where they are chosen so that a hash table would be slow.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "codec/beam/octree.hpp"
#include "codec/beam/octree_window.hpp"
#include "core/random.hpp"

namespace sweepcast::beam {
namespace {

using test::random_bits;

struct Node {
  CubePosition at{};
};

/// The hash of `NodeIndex`, as a table of 2^bits slots has it, worked out anew.
std::uint64_t slot_of(const CubePosition& at, int bits) {
  std::uint64_t h = at[0] * 0x9E3779B97F4A7C15U;
  h = (h ^ at[1]) * 0xC2B2AE3D27D4EB4FU;
  h = (h ^ at[2]) * 0x9E3779B97F4A7C15U;
  return (h >> 32) % (std::uint64_t{1} << bits);
}

CubePosition position_of(const LatticePoint& point) {
  return {static_cast<std::uint32_t>(point[0]), static_cast<std::uint32_t>(point[1]),
          static_cast<std::uint32_t>(point[2])};
}

/// In the order in which octrees have them.
std::vector<Node> in_order(std::vector<LatticePoint> points) {
  std::sort(points.begin(), points.end(), [](const LatticePoint& a, const LatticePoint& b) {
    return lattice_code(a) < lattice_code(b);
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::vector<Node> nodes;
  nodes.reserve(points.size());
  for (const LatticePoint& point : points) nodes.push_back({position_of(point)});
  return nodes;
}

LatticePoint random_point(std::mt19937& random, std::int32_t from) {
  LatticePoint point;
  for (std::int32_t& at : point) at = from + static_cast<std::int32_t>(random_bits(random) % 4096);
  return point;
}

/// Every node is found, and none where there is none.
void expect_found(const NodeIndex& index, const std::vector<Node>& nodes, std::mt19937& random) {
  for (std::uint32_t i = 0; i < nodes.size(); ++i) ASSERT_EQ(index.find(nodes, nodes[i].at), i);
  for (int i = 0; i < 2000; ++i) {
    const CubePosition at = position_of(random_point(random, -2048));
    const auto truth =
        std::find_if(nodes.begin(), nodes.end(), [&](const Node& node) { return node.at == at; });
    const auto number = static_cast<std::uint32_t>(truth - nodes.begin());
    ASSERT_EQ(index.find(nodes, at), truth == nodes.end() ? kNoNode : number);
  }
}

TEST(NodeIndex, FindsNodesAtAnyPlace) {
  std::mt19937 random(1);
  std::vector<LatticePoint> points;
  points.reserve(5000);
  for (int i = 0; i < 5000; ++i) points.push_back(random_point(random, -2048));
  const std::vector<Node> nodes = in_order(points);
  NodeIndex index;
  index.build(nodes);
  EXPECT_EQ(index.crowded_out(), 0U);
  expect_found(index, nodes, random);
}

TEST(NodeIndex, DoesNotGetSlowWhereNodesWantTheSameSlots) {
  constexpr int kBits = 13;  // of the table that 4000 nodes have
  std::mt19937 random(2);
  for (const std::int32_t from : {0, -2048}) {
    std::vector<LatticePoint> points;
    while (points.size() < 4000) {
      const LatticePoint point = random_point(random, from);
      if (slot_of(position_of(point), kBits) < 16) points.push_back(point);
    }
    const std::vector<Node> nodes = in_order(points);
    NodeIndex index;
    index.build(nodes);
    // All but those that found a slot near the first 16 are looked for by their order.
    EXPECT_GE(index.crowded_out() + 16 + NodeIndex::kMostProbes, nodes.size());
    expect_found(index, nodes, random);
    index.build(in_order({{1, 2, 3}}));
    EXPECT_EQ(index.crowded_out(), 0U);
  }
}

TEST(NodeIndex, NeighboursAreFoundAcrossTheCornerWhereCoordinatesWrap) {
  std::vector<LatticePoint> points;
  for (int x = -2; x < 2; ++x) {
    for (int y = -2; y < 2; ++y) {
      for (int z = -2; z < 2; ++z) points.push_back({x, y, z});
    }
  }
  const std::vector<Node> nodes = in_order(points);
  NodeIndex index;
  index.build(nodes);
  for (std::uint32_t side = 0; side < kSides; ++side) {
    const std::uint32_t found = index.find(nodes, beside({0, 0, 0}, side));
    ASSERT_NE(found, kNoNode) << side;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(static_cast<std::int32_t>(nodes[found].at[axis]), side_step(side, axis));
    }
  }
}

}  // namespace
}  // namespace sweepcast::beam
