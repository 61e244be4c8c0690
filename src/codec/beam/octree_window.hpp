// What lies around a cube of an octree: finding its neighbours, and their children beside it.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sweepcast::beam {

/// x, y, z of a cube, in cubes of its size from a corner of the root.
using CubePosition = std::array<std::uint32_t, 3>;

/// A cube touches 26 others: sides are numbered by x, then y, then z, each -1, 0, 1.
inline constexpr std::uint32_t kSides = 26;

/// From the cube to side `side`, on one axis: -1, 0 or 1.
[[nodiscard]] constexpr int side_step(std::uint32_t side, std::size_t axis) {
  const std::uint32_t number = side < kSides / 2 ? side : side + 1;  // 13 is the cube itself
  const std::array<std::uint32_t, 3> digits{number / 9, number / 3 % 3, number % 3};
  return static_cast<int>(digits[axis]) - 1;
}

/// The neighbour's position; it wraps round below 0, where there is no node.
[[nodiscard]] inline CubePosition beside(const CubePosition& at, std::uint32_t side) {
  CubePosition other = at;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    other[axis] += static_cast<std::uint32_t>(side_step(side, axis));
  }
  return other;
}

/// Children are numbered by their halves: 4 x + 2 y + z.
[[nodiscard]] inline CubePosition child_position(const CubePosition& at, std::uint32_t child) {
  return {at[0] * 2 + (child >> 2), at[1] * 2 + ((child >> 1) & 1U), at[2] * 2 + (child & 1U)};
}

/// A cube's children and those of its neighbours that touch them make a window of 4 x 4 x 4 cells,
/// a bit each: 16 x + 4 y + z, the cube's own from 1 to 2.
[[nodiscard]] constexpr std::uint64_t window_cell(int x, int y, int z) {
  const bool inside = x >= 0 && x < 4 && y >= 0 && y < 4 && z >= 0 && z < 4;
  return inside ? std::uint64_t{1} << (16 * x + 4 * y + z) : 0;
}

/// The cell of a cube's own child.
[[nodiscard]] constexpr std::uint64_t own_cell(std::uint32_t child) {
  return window_cell(1 + static_cast<int>(child >> 2), 1 + static_cast<int>((child >> 1) & 1U),
                     1 + static_cast<int>(child & 1U));
}

namespace window_detail {

constexpr int distance_kind(std::uint32_t side) {  // 1: by a face, 2: by an edge, 3: by a corner
  int kind = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) kind += side_step(side, axis) != 0 ? 1 : 0;
  return kind;
}

// The cells that touch each child, by kind; and those by faces one by one.
struct ChildMasks {
  std::array<std::array<std::uint64_t, 3>, 8> kind{};
  std::array<std::array<std::uint64_t, 6>, 8> face{};
};

constexpr ChildMasks make_child_masks() {
  ChildMasks masks;
  for (std::uint32_t child = 0; child < 8; ++child) {
    std::size_t faces = 0;
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const std::uint64_t cell =
          window_cell(1 + static_cast<int>(child >> 2) + side_step(side, 0),
                      1 + static_cast<int>((child >> 1) & 1U) + side_step(side, 1),
                      1 + static_cast<int>(child & 1U) + side_step(side, 2));
      const int kind = distance_kind(side);
      masks.kind[child][static_cast<std::size_t>(kind) - 1] |= cell;
      if (kind == 1) masks.face[child][faces++] = cell;
    }
  }
  return masks;
}

// The cells that the children of the neighbour at each side have, 0 for those that do not touch.
constexpr std::array<std::array<std::uint64_t, 8>, kSides> make_side_cells() {
  std::array<std::array<std::uint64_t, 8>, kSides> cells{};
  for (std::uint32_t side = 0; side < kSides; ++side) {
    for (std::uint32_t child = 0; child < 8; ++child) {
      cells[side][child] =
          window_cell(2 * side_step(side, 0) + 1 + static_cast<int>(child >> 2),
                      2 * side_step(side, 1) + 1 + static_cast<int>((child >> 1) & 1U),
                      2 * side_step(side, 2) + 1 + static_cast<int>(child & 1U));
    }
  }
  return cells;
}

inline constexpr ChildMasks kChildMasks = make_child_masks();
inline constexpr auto kSideCells = make_side_cells();

}  // namespace window_detail

/// What is known around a cube.
struct Surroundings {
  std::uint64_t filled = 0;      ///< cells that are known to hold a place
  std::uint64_t open = 0;        ///< cells of neighbours whose children are not known yet
  std::uint32_t faces = 0;       ///< which of the six neighbours by faces there are
  std::uint32_t neighbours = 0;  ///< how many of the 26

  /// Enters the neighbour at `side`; `children` counts where they are known.
  void add(std::uint32_t side, bool known, std::uint32_t children) {
    ++neighbours;
    for (std::uint32_t child = 0; child < 8; ++child) {
      const std::uint64_t cell = window_detail::kSideCells[side][child];
      if (!known) {
        open |= cell;
      } else if (((children >> child) & 1U) != 0) {
        filled |= cell;
      }
    }
    constexpr std::array<int, kSides> kFace = [] {
      std::array<int, kSides> face{};
      int number = 0;
      for (std::uint32_t i = 0; i < kSides; ++i) {
        face[i] = window_detail::distance_kind(i) == 1 ? number++ : -1;
      }
      return face;
    }();
    if (kFace[side] >= 0) faces |= 1U << kFace[side];
  }
};

/// What lies around one child.
struct ChildView {
  std::uint64_t cells;           ///< the filled ones among the 26
  std::uint32_t filled_faces;    ///< how many
  std::uint32_t filled_edges;    ///< how many
  std::uint32_t filled_corners;  ///< how many
  std::uint32_t open_faces;      ///< how many
  std::uint32_t open;            ///< by faces and edges, how many
  std::uint32_t faces;           ///< which are filled: a bit each
  std::uint32_t open_face_set;   ///< which are open: a bit each
};

[[nodiscard]] inline ChildView view_child(std::uint64_t filled, std::uint64_t open,
                                          std::uint32_t child) {
  const auto& [face, edge, corner] = window_detail::kChildMasks.kind[child];
  const auto count = [](std::uint64_t cells) {
    return static_cast<std::uint32_t>(std::popcount(cells));
  };
  ChildView view{};
  view.cells = filled & (face | edge | corner);
  view.filled_faces = count(filled & face);
  view.filled_edges = count(filled & edge);
  view.filled_corners = count(filled & corner);
  view.open_faces = count(open & face);
  view.open = view.open_faces + count(open & edge);
  const auto& cells = window_detail::kChildMasks.face[child];
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if ((filled & cells[i]) != 0) view.faces |= 1U << i;
    if ((open & cells[i]) != 0) view.open_face_set |= 1U << i;
  }
  return view;
}

inline constexpr std::uint32_t kNoNode = 0xFFFFFFFF;

/// Finds nodes by their position: a hash table with open addressing, kept at most half full. The
/// hash is the same everywhere, so that bytes can be crafted whose nodes all want the same slots:
/// what finds none within a few is looked for by its order instead.
class NodeIndex {
 public:
  static constexpr std::size_t kMostProbes = 32;

  /// `nodes`: anything with a position `at`, in the order of the positions' Morton codes, x
  /// highest, where positions that wrapped round below 0 come first.
  template <class Node>
  void build(const std::vector<Node>& nodes) {
    slots_.assign(std::bit_ceil(2 * nodes.size() + 1), kNoNode);
    crowded_out_ = 0;
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
      std::size_t slot = first_slot(nodes[i].at);
      std::size_t probes = 1;
      for (; probes <= kMostProbes && slots_[slot] != kNoNode; ++probes) slot = next(slot);
      if (probes <= kMostProbes) {
        slots_[slot] = i;
      } else {
        ++crowded_out_;
      }
    }
  }

  /// The number of the node at `at`, or kNoNode.
  template <class Node>
  [[nodiscard]] std::uint32_t find(const std::vector<Node>& nodes, const CubePosition& at) const {
    std::size_t slot = first_slot(at);
    for (std::size_t probe = 0; probe < kMostProbes; ++probe, slot = next(slot)) {
      if (slots_[slot] == kNoNode || same(nodes[slots_[slot]].at, at)) return slots_[slot];
    }
    return crowded_out_ == 0 ? kNoNode : find_by_order(nodes, at);
  }

  /// How many nodes are found by their order alone.
  [[nodiscard]] std::size_t crowded_out() const { return crowded_out_; }

 private:
  static bool same(const CubePosition& a, const CubePosition& b) {
    return ((a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2])) == 0;
  }

  // By the axis whose coordinates differ in the highest bit.
  static bool comes_before(const CubePosition& a, const CubePosition& b) {
    constexpr std::uint32_t kSign = 0x80000000U;
    std::size_t axis = 0;
    for (std::size_t other = 1; other < 3; ++other) {
      const std::uint32_t here = a[axis] ^ b[axis];
      const std::uint32_t there = a[other] ^ b[other];
      if (std::bit_width(there) > std::bit_width(here)) axis = other;
    }
    return (a[axis] ^ kSign) < (b[axis] ^ kSign);
  }

  template <class Node>
  [[nodiscard]] static std::uint32_t find_by_order(const std::vector<Node>& nodes,
                                                   const CubePosition& at) {
    const auto found = std::lower_bound(
        nodes.begin(), nodes.end(), at,
        [](const Node& node, const CubePosition& wanted) { return comes_before(node.at, wanted); });
    if (found == nodes.end() || !same(found->at, at)) return kNoNode;
    return static_cast<std::uint32_t>(found - nodes.begin());
  }

  [[nodiscard]] std::size_t next(std::size_t slot) const {
    return (slot + 1) & (slots_.size() - 1);
  }

  [[nodiscard]] std::size_t first_slot(const CubePosition& at) const {
    std::uint64_t h = at[0] * 0x9E3779B97F4A7C15U;
    h = (h ^ at[1]) * 0xC2B2AE3D27D4EB4FU;
    h = (h ^ at[2]) * 0x9E3779B97F4A7C15U;
    return static_cast<std::size_t>(h >> 32) & (slots_.size() - 1);
  }

  std::vector<std::uint32_t> slots_;
  std::size_t crowded_out_ = 0;
};

}  // namespace sweepcast::beam
