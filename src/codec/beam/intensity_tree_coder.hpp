// Codes intensities as integers of up to 16 bits, from the intensities around them: bit by bit,
// which is slow and small.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "codec/beam/intensity_estimator.hpp"
#include "codec/entropy/mixer.hpp"

namespace sweepcast::beam {

/// A value is a number of `bits` bits, coded from its highest. Under a logistic distribution around
/// an estimate each bit has a probability; that is one context of four, so that its scale is learnt
/// and not assumed. Integer arithmetic throughout; one function serves both directions.
class IntensityTreeCoder {
 public:
  IntensityTreeCoder() : mixer_(16, kWeightSets) {}

  /// Begins a sweep of `rows` rows; forgets what was learnt.
  void begin(int rows, int bits) {
    bits_ = bits;
    mixer_.reset();
    estimator_.begin(rows, bits);
  }

  /// Codes one value. `set` tells apart neighbourhoods of different shape, below `kSets`; rows are
  /// counted to `rows`, which stands for none. Decoding, `truth` is not used.
  template <class Coder>
  std::int32_t code(Coder& coder, const IntensityNeighbours& near, std::size_t set, std::size_t row,
                    std::int32_t truth) {
    const auto estimate = estimator_.estimate(near, set, row);
    const std::int32_t scale = std::max(kSmallestScale, estimate.error * 185 / 256);
    const std::int32_t a = near.value[0];
    const std::int32_t b = near.value[1];
    const std::uint32_t sides = coarse(a) * 50U + coarse(b);
    const std::uint32_t beyond = coarse(near.value[2]) * 50U + coarse((a + b) / 2);
    const std::uint32_t about =
        static_cast<std::uint32_t>(row) * 16U +
        static_cast<std::uint32_t>((std::int64_t{estimate.value} * 16) >> (bits_ + 4));
    std::array<std::uint32_t, 3> place{};  // of four bits' probabilities, which lie side by side
    std::uint32_t prefix = 1;
    std::uint32_t node = 1;
    std::int32_t low = 0;
    std::int32_t high = 1 << bits_;
    std::uint32_t from = 0;  // shares of the distribution below `low` and `high`, 1/65536
    std::uint32_t to = 65'536;
    for (int depth = 0; depth < bits_; ++depth) {
      if (depth % 4 == 0) {
        // Of long values only the first bits have a meaning of their own.
        prefix = depth < 8 ? prefix * 16U + node : 1'000U + static_cast<std::uint32_t>(depth);
        node = 1;
        place = {hash_context(prefix, sides + 1'000U) << 4,
                 hash_context(prefix, beyond + 10'000U) << 4,
                 hash_context(prefix, about + 30'000U) << 4};
      }
      const std::int32_t middle = (low + high) / 2;
      const std::uint32_t share_below = std::clamp(below(middle, estimate.value, scale), from, to);
      const std::uint32_t chance = chance_of_upper(from, share_below, to);
      const BitMixer<4>::Contexts contexts{place[0] + node, place[1] + node, place[2] + node,
                                           hash_context(chance, estimate.spread + 20'000U)};
      const int bit = bits_ - 1 - depth;
      const auto weights =
          static_cast<std::size_t>(chance / 4U * 8U) + static_cast<std::size_t>(bit & 7);
      const bool upper = mixer_.code(coder, contexts, weights, ((truth >> bit) & 1) != 0);
      node = node * 2 + (upper ? 1U : 0U);
      (upper ? low : high) = middle;
      (upper ? from : to) = share_below;
    }
    estimator_.learn(estimate, low);
    return low;
  }

 private:
  static constexpr std::size_t kWeightSets = std::size_t{17} * 8;
  static constexpr std::uint32_t kUnknownChance = 65;
  static constexpr std::int32_t kOne = IntensityEstimator::kOne;
  static constexpr std::int32_t kSmallestScale = 6;

  [[nodiscard]] std::uint32_t coarse(std::int32_t value) const {
    return value < 0 ? 0U : 1U + static_cast<std::uint32_t>((std::int64_t{value} * 42) >> bits_);
  }

  // Share of the distribution around `centre` that lies below a value, 1/65536.
  [[nodiscard]] static std::uint32_t below(std::int32_t value, std::int32_t centre,
                                           std::int32_t scale) {
    const std::int32_t apart = value * kOne - kOne / 2 - centre;
    const std::int32_t limit = scale * 8;  // where the logistic domain ends
    if (apart >= limit) return squash(kLogisticLimit);
    if (apart <= -limit) return squash(-kLogisticLimit);
    return squash(static_cast<int>(std::int64_t{apart} * kLogisticOne / scale));
  }

  // The chance of the upper part of a distribution that is known to lie between two shares, in 65
  // steps that are even in the logistic domain.
  [[nodiscard]] static std::uint32_t chance_of_upper(std::uint32_t from, std::uint32_t at,
                                                     std::uint32_t to) {
    if (to <= from + 1) return kUnknownChance;
    const std::uint32_t chance = (to - at) * 65'535U / (to - from);
    return static_cast<std::uint32_t>(stretch(chance) + kLogisticLimit + 1) >> 6;
  }

  int bits_ = 8;
  BitMixer<4> mixer_;
  IntensityEstimator estimator_;
};

}  // namespace sweepcast::beam
