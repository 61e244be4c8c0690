#include "codec/beam/octree.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "codec/beam/octree_coder.hpp"
#include "codec/entropy/range_coder.hpp"

namespace sweepcast::beam {
namespace {

constexpr int kDepth = 21;  // coordinates take 21 bits each

// Puts two zeros between any two of a number's lowest 21 bits.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x001F00000000FFFFU;
  bits = (bits | bits << 16) & 0x001F0000FF0000FFU;
  bits = (bits | bits << 8) & 0x100F00F00F00F00FU;
  bits = (bits | bits << 4) & 0x10C30C30C30C30C3U;
  return (bits | bits << 2) & 0x1249249249249249U;
}

// Takes every third bit.
std::uint64_t gather(std::uint64_t bits) {
  bits &= 0x1249249249249249U;
  bits = (bits | bits >> 2) & 0x10C30C30C30C30C3U;
  bits = (bits | bits >> 4) & 0x100F00F00F00F00FU;
  bits = (bits | bits >> 8) & 0x001F0000FF0000FFU;
  bits = (bits | bits >> 16) & 0x001F00000000FFFFU;
  return (bits | bits >> 32) & 0x1FFFFFU;
}

// Half the root cube's side, as a power of two: all coordinates lie in [-2^half, 2^half).
template <class Coder>
int code_half(Coder& coder, int half) {
  int coded = 0;
  for (int bit = 5; bit-- > 0;) {
    coded =
        coded * 2 + (coder.code(((half >> bit) & 1) != 0, 1U << (kProbabilityBits - 1)) ? 1 : 0);
  }
  return coded;
}

}  // namespace

std::uint64_t lattice_code(const LatticePoint& point) {
  std::uint64_t code = 0;
  for (const std::int32_t coordinate : point) {
    code = code << 1 | spread(static_cast<std::uint32_t>(coordinate + kLatticeLimit));
  }
  return code;
}

LatticePoint lattice_point(std::uint64_t code) {
  LatticePoint point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    point[axis] = static_cast<std::int32_t>(gather(code >> (2 - axis))) - kLatticeLimit;
  }
  return point;
}

void sort_for_octree(std::vector<LatticePoint>& points, std::vector<std::uint32_t>& belongings) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> codes(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    codes[i] = {lattice_code(points[i]), belongings[i]};
  std::sort(codes.begin(), codes.end());
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = lattice_point(codes[i].first);
    belongings[i] = codes[i].second;
  }
}

void write_octree(std::span<const LatticePoint> points, std::vector<std::byte>& out) {
  if (points.empty()) return;
  int half = 0;
  for (const LatticePoint& point : points) {
    for (const std::int32_t coordinate : point) {
      const auto reach = static_cast<std::uint32_t>(coordinate < 0 ? ~coordinate : coordinate);
      half = std::max(half, static_cast<int>(std::bit_width(reach)));
    }
  }
  std::vector<OctreePlace> places;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i == 0 || points[i] != points[i - 1]) {
      OctreePlace place;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        place.at[axis] = static_cast<std::uint32_t>(points[i][axis] + (1 << half));
      }
      places.push_back(place);
    }
    ++places.back().points;
  }
  RangeEncoder coder(out);
  code_half(coder, half);
  // Fails only for what cannot be: more places than points.
  static_cast<void>(OctreeCoder<RangeEncoder>(coder).code(places, half + 1, points.size()));
  coder.finish();
}

bool read_octree(std::span<const std::byte> bytes, std::vector<LatticePoint>& points) {
  if (points.empty()) return true;
  RangeDecoder coder(bytes);
  const int half = code_half(coder, 0);
  std::vector<OctreePlace> places;
  if (half >= kDepth) return false;
  if (!OctreeCoder<RangeDecoder>(coder).code(places, half + 1, points.size())) return false;
  std::size_t at = 0;
  for (const OctreePlace& place : places) {
    LatticePoint point;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      point[axis] = static_cast<std::int32_t>(place.at[axis]) - (1 << half);
    }
    for (std::uint32_t i = 0; i < place.points; ++i) points[at++] = point;
  }
  return !coder.overran();
}

void append_places(std::span<const LatticePoint> points, double step, PointCloud& cloud) {
  for (const LatticePoint& point : points) {
    cloud.x.push_back(static_cast<float>(point[0] * step));
    cloud.y.push_back(static_cast<float>(point[1] * step));
    cloud.z.push_back(static_cast<float>(point[2] * step));
  }
}

}  // namespace sweepcast::beam
