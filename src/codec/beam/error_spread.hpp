// How far predictions are off as a rule, and what that lets expect of a cell.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/entropy/logistic.hpp"

namespace sweepcast::beam {

/// The mean size of errors under one context, as it was seen.
struct SpreadMemory {
  std::int32_t mean = 0;  ///< 1/256 of a step
  std::int32_t seen = 0;  ///< errors, at most kMostSeen

  static constexpr std::int32_t kMostSeen = 60;
  static constexpr std::int32_t kLargest = 96 * 16;  ///< errors beyond count as that

  /// `size`: 1/256 of a step.
  void learn(std::int32_t size) {
    mean += ((std::min(size, kLargest) - mean) * kRates[static_cast<std::size_t>(seen)]) >> 16;
    seen = std::min(seen + 1, kMostSeen);
  }

 private:
  static constexpr auto kRates = [] {
    std::array<std::int32_t, std::size_t{kMostSeen} + 1> rates{};
    for (std::int32_t n = 0; n <= kMostSeen; ++n) {
      rates[static_cast<std::size_t>(n)] = 2 * 65'536 / (2 * n + 3);
    }
    return rates;
  }();
};

/// Expects errors to be spread as the logistic distribution has it, about `offset` (1/16 of a
/// step), with a mean size of `mean` (1/256 of a step). All answers are in the logistic domain:
/// with F the distribution, ln F / (1 - F) is linear in the error, so that
/// ln (more than k) / (just k) = ln(1 + e^-y) - ln(e^d - 1), where y is the lower edge of k's cell
/// and d a cell's width.
class LogisticErrors {
 public:
  LogisticErrors() = default;
  LogisticErrors(std::int32_t offset, std::int32_t mean)
      : offset_(offset),
        width_(kWidth / std::max(mean, kLeastMean)),
        below_width_(softplus_inverse(width_)) {}

  /// Of the number of steps: not 0, against 0.
  [[nodiscard]] std::int32_t nonzero() const {
    const std::int32_t above = softplus(-place(-8));
    const std::int32_t below = softplus(place(8));
    const std::int32_t either = std::max(above, below) + softplus(-std::abs(above - below));
    return clip(either - below_width_);
  }
  /// Of a number that is not 0: negative, against positive.
  [[nodiscard]] std::int32_t negative() const {
    return clip(softplus(place(8)) - softplus(-place(-8)));
  }
  /// Of a number at least `size` in the direction `sign`, +-1: more, against just so.
  [[nodiscard]] std::int32_t more(std::int32_t size, std::int32_t sign) const {
    return clip(softplus(-sign * place(sign * (16 * size - 8))) - below_width_);
  }

 private:
  // The mean size is 2 ln 2 times the scale of the distribution: 256 x 256 x 2 ln 2.
  static constexpr std::int32_t kWidth = 90'852;
  static constexpr std::int32_t kLeastMean = 24;

  [[nodiscard]] std::int32_t place(std::int32_t sixteenths) const {
    return ((sixteenths - offset_) * width_) >> 4;
  }
  static std::int32_t clip(std::int32_t x) {
    return std::clamp(x, -kLogisticLimit, kLogisticLimit);
  }

  std::int32_t offset_ = 0;
  std::int32_t width_ = 256;  ///< of a step
  std::int32_t below_width_ = 0;
};

/// Several expectations of the same cell, each from what was seen under a context of its own.
template <std::size_t kCount>
class ErrorSpreads {
 public:
  void reset() { std::fill(memories_.begin(), memories_.end(), SpreadMemory{}); }
  /// As if no memory had seen more than that.
  void soften(std::int32_t most) {
    for (SpreadMemory& memory : memories_) memory.seen = std::min(memory.seen, most);
  }

  /// Looks up the memories of a cell. `first`: the mean size where nothing was seen.
  void look_up(const std::array<std::uint32_t, kCount>& contexts, std::int32_t offset,
               std::int32_t first) {
    for (std::size_t k = 0; k < kCount; ++k) {
      now_[k] = &memories_[k * kSize + (contexts[k] & (kSize - 1))];
      if (now_[k]->seen == 0) now_[k]->mean = first;
      errors_[k] = LogisticErrors(offset, now_[k]->mean);
    }
  }
  /// The size of the cell's error, 1/256 of a step.
  void learn(std::int32_t size) {
    for (SpreadMemory* memory : now_) memory->learn(size);
  }
  [[nodiscard]] const LogisticErrors& operator[](std::size_t k) const { return errors_[k]; }

 private:
  static constexpr std::size_t kSize = 4096;
  std::vector<SpreadMemory> memories_ = std::vector<SpreadMemory>(kCount * kSize);
  std::array<SpreadMemory*, kCount> now_{};
  std::array<LogisticErrors, kCount> errors_{};
};

}  // namespace sweepcast::beam
