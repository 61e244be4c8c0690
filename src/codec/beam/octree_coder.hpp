// Codes places of a lattice as an octree, level by level: which of a cube's eight children hold a
// place, told by what is known around it; then how many points each place has.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/beam/octree_window.hpp"
#include "codec/entropy/mixer.hpp"

namespace sweepcast::beam {

/// A place and how many points it has. Coordinates count from a corner of the root cube.
struct OctreePlace {
  CubePosition at{};
  std::uint32_t points = 0;
};

/// Serves both directions: `Coder` is RangeEncoder or RangeDecoder.
template <class Coder>
class OctreeCoder {
 public:
  explicit OctreeCoder(Coder& coder) : coder_(coder) {}

  /// Codes places within a root cube of 2^depth places a side, of `points` points in all.
  /// Encoding: `places` in the order of their Morton codes, none twice. Decoding: overwritten;
  /// false where there cannot be that many.
  [[nodiscard]] bool code(std::vector<OctreePlace>& places, int depth, std::uint64_t points) {
    places_ = &places;
    centre_ = std::int64_t{1} << (depth - 1);
    nodes_.assign(1, {{}, 0, static_cast<std::uint32_t>(places.size()), 0});
    for (int level = depth; level > 0; --level) {
      if (!code_level(level, points)) return false;
    }
    places.resize(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) places[i].at = nodes_[i].at;
    return code_counts(points);
  }

 private:
  /// A cube that holds a place.
  struct Node {
    CubePosition at{};        ///< in cubes of its size
    std::uint32_t first = 0;  ///< encoding: its places
    std::uint32_t count = 0;  ///< encoding: how many
    std::uint32_t single =
        0;  ///< where it is known to hold one place: its number in `singles_` + 1
  };

  // Codes the children of all nodes, which are cubes of 2^level places a side.
  bool code_level(int level, std::uint64_t most) {
    index_.build(nodes_);
    children_.assign(nodes_.size(), 0);
    next_.clear();
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (nodes_[i].single != 0) children_[i] = child_of_single(nodes_[i], level);
    }
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (nodes_[i].single == 0) code_node(i, level);
      if (ran_dry(coder_)) return false;
      append_children(nodes_[i], children_[i], level);
      if (next_.size() > most) return false;
    }
    nodes_.swap(next_);
    return true;
  }

  void code_node(std::size_t i, int level) {
    Node& node = nodes_[i];
    const Surroundings around = look_around(i);
    const std::uint32_t far = distance(node.at, level);
    if (level > 1 && code_single(node, level, around, far)) {
      children_[i] = child_of_single(node, level);
    } else {
      children_[i] = code_children(node, level, around);
    }
  }

  // Whether the node holds one place alone; then where.
  bool code_single(Node& node, int level, const Surroundings& around, std::uint32_t far) {
    const auto at = static_cast<std::uint32_t>(level);
    const std::uint32_t near = std::min(around.neighbours, 7U);
    const BitMixer<3>::Contexts contexts{hash_context(at, 1000U + near),
                                         hash_context(far, std::min(at - 1, 4U) * 32U + near),
                                         hash_context(at, far)};
    if (!single_.code(coder_, contexts, std::min(at, 7U), node.count == 1)) return false;
    CubePosition place{};
    if (node.first < places_->size()) place = (*places_)[node.first].at;
    CubePosition path = node.at;
    for (int level_below = level; level_below-- > 0;) {
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const auto below = static_cast<std::uint32_t>(level_below);
        const BitMixer<3>::Contexts c{hash_context(below, axis),
                                      hash_context(axis, far * 64U + below),
                                      hash_context(below, 77U)};
        const bool bit = path_.code(coder_, c, axis, ((place[axis] >> below) & 1U) != 0);
        path[axis] = path[axis] * 2 + (bit ? 1U : 0U);
      }
    }
    singles_.push_back(path);
    node.single = static_cast<std::uint32_t>(singles_.size());
    return true;
  }

  // Child by child: does it hold a place? The last must where no other does.
  std::uint8_t code_children(const Node& node, int level, const Surroundings& around) {
    const std::uint32_t truth = children_to_code(node, level);
    const auto depth = std::min(static_cast<std::uint32_t>(level) - 1, 4U);
    std::uint64_t filled = around.filled;
    std::uint32_t children = 0;
    for (std::uint32_t child = 0; child < 8; ++child) {
      if (child == 7 && children == 0) return 128;
      const ChildView view = view_child(filled, around.open, child);
      const auto so_far = static_cast<std::uint32_t>(std::popcount(children));
      const auto height =
          static_cast<std::uint32_t>(level) * 0x1000000U + node.at[2] * 2 + (child & 1U);
      const std::uint32_t beside = view.filled_faces + view.filled_edges;
      const BitMixer<6>::Contexts contexts{
          hash_context(child * 64U + view.faces, view.open_face_set * 8U + depth),
          hash_context((view.filled_faces * 16U + view.filled_edges) * 16U + view.filled_corners,
                       std::min(view.open, 7U) * 8U + depth),
          hash_context(child * 64U + around.faces, 2000U + depth * 8U + so_far),
          hash_context(static_cast<std::uint32_t>(view.cells >> 32),
                       hash_context(static_cast<std::uint32_t>(view.cells), depth * 8U + child)),
          hash_context(height, 6000U + beside),
          hash_context(view.faces * 64U + around.faces, 8000U + child)};
      const std::size_t set = std::min(view.filled_faces, 3U) * 16U +
                              std::min(view.filled_edges + view.open - view.open_faces, 15U);
      if (occupied_.code(coder_, contexts, set, ((truth >> child) & 1U) != 0)) {
        children |= 1U << child;
        filled |= own_cell(child);
      }
    }
    return static_cast<std::uint8_t>(children);
  }

  // The places' numbers of points: how many bits, then the bits below the highest.
  bool code_counts(std::uint64_t points) {
    index_.build(nodes_);
    std::uint32_t last = 1;
    std::uint32_t before = 1;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      std::uint32_t& own = (*places_)[i].points;
      own = code_count(i, own, std::bit_width(last) * 6U + std::bit_width(before));
      if (own > points || ran_dry(coder_)) return false;
      points -= own;
      before = std::min(last, kLargestSeen);
      last = std::min(own, kLargestSeen);
    }
    return points == 0;
  }

  std::uint32_t code_count(std::size_t i, std::uint32_t truth, std::uint32_t lately) {
    const CubePosition& at = nodes_[i].at;
    std::uint64_t sum = 0;
    std::uint32_t known = 0;
    std::uint32_t neighbours = 0;
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const std::uint32_t other = index_.find(nodes_, beside(at, side));
      if (other == kNoNode) continue;
      ++neighbours;
      if (other >= i) continue;
      ++known;
      sum += 4U * std::uint64_t{(*places_)[other].points};
    }
    const auto mean = known == 0 ? 0U : static_cast<std::uint32_t>(std::bit_width(sum / known));
    const std::uint32_t far = distance(at, 0);
    const auto width = static_cast<std::uint32_t>(std::bit_width(truth));
    std::uint32_t bits = 1;
    for (; bits < kMostBits; ++bits) {
      const BitMixer<4>::Contexts contexts{hash_context(bits, mean * 32U + std::min(known, 3U)),
                                           hash_context(bits, 1000U + far * 32U + neighbours / 2),
                                           hash_context(bits, 2000U + lately),
                                           hash_context(bits, 3000U + far * 32U + mean)};
      if (!width_.code(coder_, contexts, std::min(bits, 15U), width > bits)) break;
    }
    std::uint32_t value = 1;
    for (std::uint32_t bit = bits - 1; bit-- > 0;) {
      const std::uint32_t high = std::min(value, 64U);
      const BitMixer<3>::Contexts contexts{hash_context(bits, high),
                                           hash_context(bits * 64U + high, 100U + mean),
                                           hash_context(bits * 64U + high, 5000U + far)};
      const bool one =
          digits_.code(coder_, contexts, std::min(bits, 15U), ((truth >> bit) & 1U) != 0);
      value = value * 2 + (one ? 1U : 0U);
    }
    return value;
  }

  // What is known of the children of the nodes around.
  Surroundings look_around(std::size_t i) const {
    Surroundings around;
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const std::uint32_t other = index_.find(nodes_, beside(nodes_[i].at, side));
      if (other == kNoNode) continue;
      const bool known = other < i || nodes_[other].single != 0;
      around.add(side, known, children_[other]);
    }
    return around;
  }

  // Encoding: the children that hold places.
  std::uint32_t children_to_code(const Node& node, int level) const {
    std::uint32_t children = 0;
    for (std::uint32_t i = 0; i < node.count; ++i) {
      children |= 1U << child_at((*places_)[node.first + i].at, level);
    }
    return children;
  }

  std::uint8_t child_of_single(const Node& node, int level) const {
    return static_cast<std::uint8_t>(1U << child_at(singles_[node.single - 1], level));
  }

  // Which child of its cube of 2^level places a side holds a place.
  static std::uint32_t child_at(const CubePosition& place, int level) {
    std::uint32_t child = 0;
    for (const std::uint32_t coordinate : place) {
      child = child * 2 + ((coordinate >> (level - 1)) & 1U);
    }
    return child;
  }

  void append_children(const Node& node, std::uint32_t children, int level) {
    std::uint32_t first = node.first;
    const std::uint32_t end = node.first + node.count;
    for (std::uint32_t child = 0; child < 8; ++child) {
      if (((children >> child) & 1U) == 0) continue;
      Node below{child_position(node.at, child), first, 0, node.single};
      while (first < end && child_at((*places_)[first].at, level) == child) ++first;
      below.count = first - below.first;
      next_.push_back(below);
    }
  }

  // Twice the logarithm of a cube's distance from the sensor: points lie the farther apart.
  std::uint32_t distance(const CubePosition& at, int level) const {
    std::uint64_t sum = 0;
    for (const std::uint32_t coordinate : at) {
      const std::int64_t middle =
          (std::int64_t{coordinate} << level) + ((std::int64_t{1} << level) >> 1) - centre_;
      sum += static_cast<std::uint64_t>(middle * middle);
    }
    return static_cast<std::uint32_t>(std::bit_width(sum));
  }

  static constexpr std::uint32_t kMostBits = 25;     // of a place's number of points
  static constexpr std::uint32_t kLargestSeen = 31;  // contexts tell larger numbers not apart

  Coder& coder_;
  std::vector<OctreePlace>* places_ = nullptr;
  std::int64_t centre_ = 0;  ///< the sensor's place, on each axis
  std::vector<Node> nodes_, next_;
  std::vector<std::uint8_t> children_;  ///< of `nodes_`, as far as they are known: one bit each
  std::vector<CubePosition> singles_;
  NodeIndex index_;
  BitMixer<6> occupied_{16, 64};
  BitMixer<3> single_{12, 8}, path_{12, 3}, digits_{12, 16};
  BitMixer<4> width_{14, 16};
};

}  // namespace sweepcast::beam
