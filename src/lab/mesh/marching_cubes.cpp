#include "lab/mesh/marching_cubes.hpp"

namespace sweepcast::lab {

namespace {

constexpr std::array<CubeEdge, kCubeEdges> kEdges{{
    {0, 0},
    {2, 0},
    {4, 0},
    {6, 0},
    {0, 1},
    {1, 1},
    {4, 1},
    {5, 1},
    {0, 2},
    {1, 2},
    {2, 2},
    {3, 2},
}};

// The corners of the faces, counter-clockwise seen from outside the cube.
constexpr std::array<std::array<std::uint8_t, 4>, 6> kFaces{{
    {0, 4, 6, 2},
    {1, 3, 7, 5},
    {0, 1, 5, 4},
    {2, 6, 7, 3},
    {0, 2, 3, 1},
    {4, 5, 7, 6},
}};

constexpr std::uint8_t kNone = 255;

constexpr std::uint8_t edge_between(unsigned a, unsigned b) {
  for (std::uint8_t i = 0; i < kCubeEdges; ++i) {
    const unsigned begin = kEdges[i].begin;
    const unsigned end = begin | (1U << kEdges[i].axis);
    if ((a == begin && b == end) || (a == end && b == begin)) return i;
  }
  return kNone;
}

// For each edge that the surface crosses, the one where the surface's line on a face goes next. A
// walk round a face enters the inside at one edge and leaves it at the next crossing; every crossed
// edge is entered on one of its faces and left on the other, so the lines close.
constexpr std::array<std::uint8_t, kCubeEdges> follow_lines(unsigned inside) {
  std::array<std::uint8_t, kCubeEdges> next{};
  next.fill(kNone);
  const auto is_inside = [&](std::size_t corner) { return ((inside >> corner) & 1U) != 0; };
  for (const auto& face : kFaces) {
    for (std::size_t i = 0; i < 4; ++i) {
      if (is_inside(face[i]) || !is_inside(face[(i + 1) % 4])) continue;
      std::size_t last = i + 1;
      while (is_inside(face[(last + 1) % 4])) ++last;
      const std::uint8_t entered = edge_between(face[i], face[(i + 1) % 4]);
      next[entered] = edge_between(face[last % 4], face[(last + 1) % 4]);
    }
  }
  return next;
}

constexpr CubeCase make_case(unsigned inside) {
  CubeCase result;
  auto next = follow_lines(inside);
  for (std::uint8_t first = 0; first < kCubeEdges; ++first) {
    if (next[first] == kNone) continue;
    std::uint8_t second = next[first];
    next[first] = kNone;
    while (next[second] != first) {  // a fan of triangles about `first`
      const std::uint8_t third = next[second];
      result.triangles[result.count++] = {first, second, third};
      next[second] = kNone;
      second = third;
    }
    next[second] = kNone;
  }
  return result;
}

constexpr std::array<CubeCase, 256> make_cases() {
  std::array<CubeCase, 256> cases{};
  for (unsigned inside = 0; inside < 256; ++inside) cases[inside] = make_case(inside);
  return cases;
}

constexpr std::array<CubeCase, 256> kCases = make_cases();

}  // namespace

const std::array<CubeEdge, kCubeEdges> kCubeEdge = kEdges;

const CubeCase& cube_case(std::uint8_t inside) {
  return kCases[inside];
}

}  // namespace sweepcast::lab
