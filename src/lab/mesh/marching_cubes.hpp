// How a surface cuts a cube whose corners are inside or outside it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace sweepcast::lab {

/// An edge of the unit cube: parallel to `axis`, from corner `begin`. Corner c lies at
/// (c & 1, c >> 1 & 1, c >> 2 & 1).
struct CubeEdge {
  std::uint8_t begin;
  std::uint8_t axis;
};

inline constexpr std::size_t kCubeEdges = 12;

/// The edges, four along each axis.
extern const std::array<CubeEdge, kCubeEdges> kCubeEdge;

/// The triangles of one of the 256 cases: corners are edges' numbers, counter-clockwise seen from
/// outside the surface.
struct CubeCase {
  std::uint8_t count = 0;
  std::array<std::array<std::uint8_t, 3>, 10> triangles{};
};

/// The case whose bit c tells whether corner c is inside. After marching cubes (Lorensen and Cline,
/// SIGGRAPH 1987); where a face's diagonal corners are inside, both neighbours part them, so that
/// surfaces close.
[[nodiscard]] const CubeCase& cube_case(std::uint8_t inside);

}  // namespace sweepcast::lab
