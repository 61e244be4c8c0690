#include "codec/beam/octree.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "codec/entropy/range_coder.hpp"

namespace sweepcast::beam {
namespace {

constexpr int kDepth = 21;  // levels: coordinates take 21 bits each

// Interleaves the bits of the coordinates, x highest.
std::uint64_t morton(const LatticePoint& point) {
  std::uint64_t code = 0;
  for (int bit = kDepth; bit-- > 0;) {
    for (const std::int32_t coordinate : point) {
      const auto shifted = static_cast<std::uint32_t>(coordinate + kLatticeLimit);
      code = code * 2 + ((shifted >> bit) & 1U);
    }
  }
  return code;
}

LatticePoint point_of(std::uint64_t code) {
  std::array<std::uint32_t, 3> shifted{};
  for (int bit = kDepth; bit-- > 0;) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      shifted[axis] =
          shifted[axis] * 2 +
          static_cast<std::uint32_t>((code >> (3 * bit + 2 - static_cast<int>(axis))) & 1U);
    }
  }
  LatticePoint point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    point[axis] = static_cast<std::int32_t>(shifted[axis]) - kLatticeLimit;
  }
  return point;
}

// Walks the tree depth first. Each node says how many of its points lie in the lower half of each
// axis in turn: a binary split of the Morton codes. Counts of one need a bit a level, no more.
template <class Coder>
class TreeCoder {
 public:
  TreeCoder(Coder& coder, OctreeCoder::Tables& tables) : coder_(coder), tables_(tables) {}

  /// Codes the split of `codes`, which share all but their lowest `level` bits. Decoding: `codes`
  /// is where to put them, `prefix` the bits above.
  void code(std::span<std::uint64_t> codes, int level, std::uint64_t prefix, std::uint32_t parent) {
    if (level == 0) {
      for (std::uint64_t& code : codes) code = prefix;
      return;
    }
    const std::uint64_t high_bit = std::uint64_t{1} << (level - 1);
    const auto first_high = std::partition_point(
        codes.begin(), codes.end(), [&](std::uint64_t code) { return (code & high_bit) == 0; });
    const auto low = split(static_cast<std::uint32_t>(codes.size()),
                           static_cast<std::uint32_t>(first_high - codes.begin()), level, parent);
    const std::uint32_t shape = parent * 3U + (low == 0 ? 0U : low == codes.size() ? 1U : 2U);
    const std::uint32_t next = shape % 59'049U;  // the shapes of the last ten splits
    if (ran_dry(coder_)) return;
    if (low > 0) code(codes.first(low), level - 1, prefix, next);
    if (low < codes.size()) code(codes.subspan(low), level - 1, prefix | high_bit, next);
  }

 private:
  // How many of `count` lie in the lower half: whether all are on one side, which, and else a
  // number between, in bits.
  std::uint32_t split(std::uint32_t count, std::uint32_t low, int level, std::uint32_t parent) {
    const std::uint32_t size = std::min<std::uint32_t>(std::bit_width(count), 6U);
    const auto at = static_cast<std::uint32_t>(level);
    BitMixer<3>::Contexts contexts{hash_context(parent % 729U, size * 64U + at % 3U),
                                   hash_context(at, 1000U + size),
                                   hash_context(parent, 2000U + at % 3U + size * 4U)};
    bool both = false;
    if (count > 1) both = tables_.both.code(coder_, contexts, size, low > 0 && low < count);
    if (!both) {
      for (std::uint32_t& context : contexts) context = hash_context(context, 7U);
      return tables_.side.code(coder_, contexts, size, low == 0) ? 0 : count;
    }
    if (count == 2) return 1;
    // Between 1 and count - 1: a binary search, its first decisions adaptive.
    std::uint32_t from = 1;
    std::uint32_t to = count - 1;
    for (std::uint32_t step = 0; from < to; ++step) {
      const std::uint32_t middle = from + (to - from) / 2;
      const BitMixer<3>::Contexts c{hash_context(step, 3000U + size), hash_context(step, at),
                                    hash_context(step, parent % 27U + 4000U)};
      if (tables_.number.code(coder_, c, std::min(step, 7U), low > middle)) {
        from = middle + 1;
      } else {
        to = middle;
      }
    }
    return from;
  }

  Coder& coder_;
  OctreeCoder::Tables& tables_;
};

}  // namespace

void OctreeCoder::sort(std::vector<LatticePoint>& points, std::vector<std::uint32_t>& belongings) {
  places_.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) places_[i] = {morton(points[i]), belongings[i]};
  std::sort(places_.begin(), places_.end());
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = point_of(places_[i].first);
    belongings[i] = places_[i].second;
  }
}

void OctreeCoder::write(std::vector<LatticePoint>& points, std::vector<std::byte>& out) {
  if (points.empty()) return;
  codes_.resize(points.size());
  std::transform(points.begin(), points.end(), codes_.begin(), morton);
  std::sort(codes_.begin(), codes_.end());
  std::transform(codes_.begin(), codes_.end(), points.begin(), point_of);
  RangeEncoder coder(out);
  tables_.reset();
  TreeCoder(coder, tables_).code(codes_, 3 * kDepth, 0, 0);
  coder.finish();
}

bool OctreeCoder::read(std::span<const std::byte> bytes, std::vector<LatticePoint>& points) {
  if (points.empty()) return true;
  codes_.assign(points.size(), 0);
  RangeDecoder coder(bytes);
  tables_.reset();
  TreeCoder(coder, tables_).code(codes_, 3 * kDepth, 0, 0);
  std::transform(codes_.begin(), codes_.end(), points.begin(), point_of);
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
