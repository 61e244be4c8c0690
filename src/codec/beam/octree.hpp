// Points that no sensor model places: quantised to a cubic lattice and coded as an octree.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "codec/entropy/mixer.hpp"
#include "sweepcast/cloud.hpp"

namespace sweepcast::beam {

/// A point on the lattice, in steps; each coordinate within +-2^20.
using LatticePoint = std::array<std::int32_t, 3>;

inline constexpr std::int32_t kLatticeLimit = 1 << 20;

/// Codes points on the lattice; keeps its tables and buffers.
class OctreeCoder {
 public:
  /// Sorts points, and what belongs to each, into the order in which they will be decoded.
  void sort(std::vector<LatticePoint>& points, std::vector<std::uint32_t>& belongings);

  /// Sorts `points` into the order in which they will be decoded and writes them.
  void write(std::vector<LatticePoint>& points, std::vector<std::byte>& out);

  /// The inverse. `points.size()` says how many there are; false where the bytes do not have that
  /// many.
  [[nodiscard]] bool read(std::span<const std::byte> bytes, std::vector<LatticePoint>& points);

  /// What is learnt of splits.
  struct Tables {
    BitMixer<3> both{14, 8};
    BitMixer<3> side{14, 8};
    BitMixer<3> number{12, 8};

    void reset() {
      for (auto* table : {&both, &side, &number}) table->reset();
    }
  };

 private:
  Tables tables_;
  std::vector<std::uint64_t> codes_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> places_;  ///< codes and belongings
};

/// Appends the points' coordinates to a cloud: `step` is the lattice's, metres.
void append_places(std::span<const LatticePoint> points, double step, PointCloud& cloud);

}  // namespace sweepcast::beam
