// Codes intensities as integers of up to 16 bits, from the intensities around them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "codec/entropy/mixer.hpp"

namespace sweepcast::beam {

/// What is known around a point. In order: one step back and one ahead, two back, one across, two
/// ahead, three back, three ahead, four back, and the corners: back and ahead on the side across
/// that is done, back and ahead on the other.
struct IntensityNeighbours {
  static constexpr std::size_t kCount = 12;
  std::array<std::int32_t, kCount> value;  ///< -1 where not known
  std::array<std::int32_t, kCount> range;  ///< of the neighbour, any unit
  std::int32_t own_range;                  ///< the point's own, same unit
};

/// A value is a number of `bits` bits, coded from its highest. An estimate is formed of the
/// neighbours, by weights that adapt to the sweep: lasers that fire by turns differ, so that the
/// second neighbour may tell more than the first. Under a logistic distribution around the estimate
/// each bit has a probability; that is one context of four, so that its scale is learnt and not
/// assumed. Integer arithmetic throughout; one function serves both directions.
class IntensityCoder {
 public:
  IntensityCoder() : mixer_(16, kWeightSets) {}

  /// Begins a sweep of `rows` rows; forgets what was learnt.
  void begin(int rows, int bits) {
    bits_ = bits;
    mixer_.reset();
    for (auto& weights : weights_) weights.fill(0);
    bias_.assign(static_cast<std::size_t>(rows) + 1, 0);
    row_error_.assign(static_cast<std::size_t>(rows) + 1, first_error());
    spread_error_.fill(first_error());
    last_ = 1 << (bits - 2 > 0 ? bits - 2 : 0);
  }

  /// Codes one value. `set` tells apart neighbourhoods of different shape, below `kSets`; rows are
  /// counted to `rows`, which stands for none. Decoding, `truth` is not used.
  template <class Coder>
  std::int32_t code(Coder& coder, const IntensityNeighbours& near, std::size_t set, std::size_t row,
                    std::int32_t truth) {
    const Estimate estimate = estimate_of(near, set, row);
    const std::uint32_t spread = spread_of(near, estimate.mean);
    const std::int32_t scale =
        std::max(kSmallestScale, (row_error_[row] + spread_error_[spread]) / 2 * 185 / 256);
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
                                           hash_context(chance, spread + 20'000U)};
      const int bit = bits_ - 1 - depth;
      const auto weights =
          static_cast<std::size_t>(chance / 4U * 8U) + static_cast<std::size_t>(bit & 7);
      const bool upper = mixer_.code(coder, contexts, weights, ((truth >> bit) & 1) != 0);
      node = node * 2 + (upper ? 1U : 0U);
      (upper ? low : high) = middle;
      (upper ? from : to) = share_below;
    }
    learn(estimate, set, row, spread, low);
    return low;
  }

  static constexpr std::size_t kSets = 32;

 private:
  static constexpr std::size_t kCount = IntensityNeighbours::kCount;
  static constexpr std::size_t kTaps = 8;  // neighbours with a weight that adapts
  static constexpr std::size_t kSpreads = 12;
  static constexpr std::size_t kWeightSets = std::size_t{17} * 8;
  static constexpr std::uint32_t kUnknownChance = 65;
  static constexpr std::int32_t kOne = 16;  // estimates and errors are in sixteenths
  static constexpr std::int32_t kSmallestScale = 6;
  static constexpr std::int32_t kWeightLimit = 1 << 18;
  static constexpr std::int32_t kBiasLimit = 1 << 24;

  struct Estimate {
    std::int32_t mean;                      // plain weighted mean
    std::int32_t value;                     // with the weights that adapt
    std::array<std::int32_t, kTaps> input;  // differences from the mean
    std::int64_t power;
  };

  [[nodiscard]] std::int32_t first_error() const { return kOne * 5 << std::max(0, bits_ - 7); }

  [[nodiscard]] std::uint32_t coarse(std::int32_t value) const {
    return value < 0 ? 0U : 1U + static_cast<std::uint32_t>((std::int64_t{value} * 42) >> bits_);
  }

  // The mean of the neighbours, those at another depth counting little, and an adaptive filter's
  // correction (normalised least mean squares).
  [[nodiscard]] Estimate estimate_of(const IntensityNeighbours& near, std::size_t set,
                                     std::size_t row) const {
    constexpr std::array<std::int32_t, kCount> kShare{4, 4, 4, 1, 1, 0, 0, 0, 1, 1, 1, 1};
    const std::int64_t range = near.own_range;
    std::int64_t sum = 0;
    std::int64_t shares = 0;
    for (std::size_t i = 0; i < kCount; ++i) {
      if (near.value[i] < 0) continue;
      const std::int64_t apart = std::abs(near.range[i] - range);
      const int share = kShare[i] * (apart * 32 < range ? 16 : apart * 8 < range ? 4 : 1);
      shares += share;
      sum += std::int64_t{share} * near.value[i];
    }
    Estimate estimate{};
    estimate.mean =
        shares > 0 ? static_cast<std::int32_t>((sum * kOne + shares / 2) / shares) : last_ * kOne;
    estimate.power = std::int64_t{kOne} * kOne * 4;
    std::int64_t dot = 0;
    for (std::size_t i = 0; i < kTaps; ++i) {
      const bool used = near.value[i] >= 0 && std::abs(near.range[i] - range) * 8 <= range;
      const std::int32_t input = used ? near.value[i] * kOne - estimate.mean : 0;
      estimate.input[i] = input;
      estimate.power += std::int64_t{input} * input;
      dot += std::int64_t{input} * weights_[set][i];
    }
    const std::int32_t most = ((1 << bits_) - 1) * kOne;
    const std::int64_t adapted = estimate.mean + (dot >> 16) + (bias_[row] >> 4);
    estimate.value = static_cast<std::int32_t>(std::clamp<std::int64_t>(adapted, 0, most));
    return estimate;
  }

  // How far the neighbours lie from their mean, roughly logarithmically.
  [[nodiscard]] std::uint32_t spread_of(const IntensityNeighbours& near, std::int32_t mean) const {
    const std::int32_t centre = (mean + kOne / 2) / kOne;
    std::int64_t sum = 0;
    int count = 0;
    for (const std::size_t i : {0U, 1U, 2U, 3U, 4U, 8U, 9U}) {
      if (near.value[i] < 0) continue;
      sum += std::abs(near.value[i] - centre);
      ++count;
    }
    if (count == 0) return 9;
    const std::int64_t quarters = (sum * 4 / count) >> std::max(0, bits_ - 8);
    if (quarters < 4) return 0;
    const auto exponent =
        static_cast<std::uint32_t>(std::bit_width(static_cast<std::uint64_t>(quarters)) - 3);
    const auto half = static_cast<std::uint32_t>((quarters >> (exponent + 1)) & 1);
    return std::min<std::uint32_t>(exponent * 2U + half, kSpreads - 1);
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

  void learn(const Estimate& estimate, std::size_t set, std::size_t row, std::uint32_t spread,
             std::int32_t value) {
    const std::int32_t error = value * kOne - estimate.value;
    bias_[row] = std::clamp(bias_[row] + error / 8, -kBiasLimit, kBiasLimit);
    for (std::size_t i = 0; i < kTaps; ++i) {
      const std::int64_t change = std::int64_t{estimate.input[i]} * error * 300 / estimate.power;
      weights_[set][i] = static_cast<std::int32_t>(
          std::clamp<std::int64_t>(weights_[set][i] + change, -kWeightLimit, kWeightLimit));
    }
    row_error_[row] += (std::abs(error) - row_error_[row]) / 16;
    spread_error_[spread] += (std::abs(error) - spread_error_[spread]) / 32;
    last_ = value;
  }

  int bits_ = 8;
  BitMixer<4> mixer_;
  std::array<std::array<std::int32_t, kTaps>, kSets> weights_{};  // 1/65536
  std::vector<std::int32_t> bias_;                                // by row: of the estimate, 1/256
  std::vector<std::int32_t> row_error_;                           // by row: mean absolute error
  std::array<std::int32_t, kSpreads> spread_error_{};
  std::int32_t last_ = 0;
};

}  // namespace sweepcast::beam
