// Estimates a point's intensity from the intensities around it.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace sweepcast::beam {

/// What is known around a point. In order: one step back and one ahead, two back, one across, two
/// ahead, three back, three ahead, four back, and the corners: back and ahead on the side across
/// that is done, back and ahead on the other.
struct IntensityNeighbours {
  static constexpr std::size_t kCount = 12;
  std::array<std::int32_t, kCount> value;  ///< -1 where not known
  std::array<std::int32_t, kCount> range;  ///< of the neighbour, any unit, below 2^30
  std::int32_t own_range;                  ///< the point's own, same unit
};

/// The mean of the neighbours, those at another depth counting little, and the correction of an
/// adaptive filter (normalised least mean squares): lasers that fire by turns differ, so that the
/// second neighbour may tell more than the first. Integer arithmetic throughout.
class IntensityEstimator {
 public:
  static constexpr std::size_t kSets = 32;
  static constexpr std::size_t kSpreads = 12;
  static constexpr std::size_t kTaps = 8;   ///< neighbours with a weight that adapts
  static constexpr std::int32_t kOne = 16;  ///< estimates and errors are in sixteenths

  struct Estimate {
    std::int32_t value = 0;
    std::int32_t error = 0;    ///< what to expect, at least 1
    std::uint32_t spread = 0;  ///< how far the neighbours lie apart, below kSpreads
    // For `learn`.
    std::size_t set = 0, row = 0;
    std::array<std::int32_t, kTaps> input{};  // differences from the mean
    std::int64_t power = 0;
  };

  /// Begins a sweep of `rows` rows of values of `bits` bits; forgets what was learnt.
  void begin(int rows, int bits) {
    bits_ = bits;
    for (auto& weights : weights_) weights.fill(0);
    bias_.assign(static_cast<std::size_t>(rows) + 1, 0);
    row_error_.assign(static_cast<std::size_t>(rows) + 1, first_error());
    spread_error_.fill(first_error());
    last_ = 1 << std::max(bits - 2, 0);
  }

  /// `set` tells apart neighbourhoods of different shape, below `kSets`; rows are counted to
  /// `rows`, which stands for none.
  [[nodiscard]] Estimate estimate(const IntensityNeighbours& near, std::size_t set,
                                  std::size_t row) const {
    constexpr std::array<std::int32_t, IntensityNeighbours::kCount> kShare{4, 4, 4, 1, 1, 0,
                                                                           0, 0, 1, 1, 1, 1};
    std::array<bool, kShare.size()> close;
    std::int32_t sum = 0;
    std::int32_t shares = 0;
    for (std::size_t i = 0; i < kShare.size(); ++i) {
      const std::int32_t apart = std::abs(near.range[i] - near.own_range);
      const std::int32_t trust = apart < near.own_range >> 5   ? 16
                                 : apart < near.own_range >> 3 ? 4
                                                               : 1;
      const std::int32_t share = near.value[i] < 0 ? 0 : kShare[i] * trust;
      close[i] = near.value[i] >= 0 && trust > 1;
      shares += share;
      sum += share * near.value[i];
    }
    Estimate estimate;
    estimate.set = set;
    estimate.row = row;
    const std::int32_t mean = shares > 0 ? (sum * kOne + shares / 2) / shares : last_ * kOne;
    estimate.power = std::int64_t{kOne} * kOne * 4;
    std::int64_t dot = 0;
    for (std::size_t i = 0; i < kTaps; ++i) {
      const std::int32_t input = close[i] ? near.value[i] * kOne - mean : 0;
      estimate.input[i] = input;
      estimate.power += std::int64_t{input} * input;
      dot += std::int64_t{input} * weights_[set][i];
    }
    const std::int32_t most = ((1 << bits_) - 1) * kOne;
    estimate.value = static_cast<std::int32_t>(
        std::clamp<std::int64_t>(mean + (dot >> 16) + (bias_[row] >> 4), 0, most));
    estimate.spread = spread_of(near, mean);
    estimate.error = std::max(1, (row_error_[row] + spread_error_[estimate.spread]) / 2);
    return estimate;
  }

  void learn(const Estimate& estimate, std::int32_t value) {
    const std::int32_t error = value * kOne - estimate.value;
    std::int32_t& bias = bias_[estimate.row];
    bias = std::clamp(bias + error / 8, -kBiasLimit, kBiasLimit);
    const std::int64_t gain = std::int64_t{error} * (300 << 20) / estimate.power;
    auto& weights = weights_[estimate.set];
    for (std::size_t i = 0; i < kTaps; ++i) {
      const std::int64_t changed = weights[i] + ((estimate.input[i] * gain) >> 20);
      weights[i] =
          static_cast<std::int32_t>(std::clamp<std::int64_t>(changed, -kWeightLimit, kWeightLimit));
    }
    std::int32_t& row_error = row_error_[estimate.row];
    row_error += (std::abs(error) - row_error) / 16;
    std::int32_t& spread_error = spread_error_[estimate.spread];
    spread_error += (std::abs(error) - spread_error) / 32;
    last_ = value;
  }

 private:
  static constexpr std::int32_t kWeightLimit = 1 << 18;
  static constexpr std::int32_t kBiasLimit = 1 << 24;

  [[nodiscard]] std::int32_t first_error() const { return kOne * 5 << std::max(0, bits_ - 7); }

  // How far the neighbours lie from their mean, roughly logarithmically.
  [[nodiscard]] std::uint32_t spread_of(const IntensityNeighbours& near, std::int32_t mean) const {
    const std::int32_t centre = (mean + kOne / 2) / kOne;
    std::int32_t sum = 0;
    std::int32_t count = 0;
    for (const std::size_t i : {0U, 1U, 2U, 3U, 4U, 8U, 9U}) {
      const bool known = near.value[i] >= 0;
      sum += known ? std::abs(near.value[i] - centre) : 0;
      count += known ? 1 : 0;
    }
    if (count == 0) return 9;
    const auto quarters = static_cast<std::uint32_t>((sum * 4 / count) >> std::max(0, bits_ - 8));
    if (quarters < 4) return 0;
    const auto exponent = static_cast<std::uint32_t>(std::bit_width(quarters)) - 3;
    return std::min<std::uint32_t>(exponent * 2 + ((quarters >> (exponent + 1)) & 1U),
                                   kSpreads - 1);
  }

  int bits_ = 8;
  std::array<std::array<std::int32_t, kTaps>, kSets> weights_{};  // 1/65536
  std::vector<std::int32_t> bias_;                                // by row: of the estimate, 1/256
  std::vector<std::int32_t> row_error_;                           // by row: mean absolute error
  std::array<std::int32_t, kSpreads> spread_error_{};
  std::int32_t last_ = 0;
};

}  // namespace sweepcast::beam
