// Points that no sensor model places: quantised to a cubic lattice and coded as an octree.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sweepcast/cloud.hpp"

namespace sweepcast::beam {

/// A point on the lattice, in steps; each coordinate within +-2^20.
using LatticePoint = std::array<std::int32_t, 3>;

inline constexpr std::int32_t kLatticeLimit = 1 << 20;

/// The bits of the coordinates + 2^20 interleaved, x highest (Morton's code); and back.
[[nodiscard]] std::uint64_t lattice_code(const LatticePoint& point);
[[nodiscard]] LatticePoint lattice_point(std::uint64_t code);

/// Sorts points, and what belongs to each, into the order in which they will be decoded.
void sort_for_octree(std::vector<LatticePoint>& points, std::vector<std::uint32_t>& belongings);

/// Writes points that `sort_for_octree` has sorted.
void write_octree(std::span<const LatticePoint> points, std::vector<std::byte>& out);

/// The inverse. `points.size()` says how many there are; false where the bytes do not have that
/// many.
[[nodiscard]] bool read_octree(std::span<const std::byte> bytes, std::vector<LatticePoint>& points);

/// Appends the points' coordinates to a cloud: `step` is the lattice's, metres.
void append_places(std::span<const LatticePoint> points, double step, PointCloud& cloud);

}  // namespace sweepcast::beam
