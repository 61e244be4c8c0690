// Codes integers of any size: mostly small, adaptively.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "codec/entropy/mixer.hpp"

namespace sweepcast::beam {

/// Codes signed integers as: zero or not, sign, number of bits, and the bits, of which the first
/// few are modelled. `Coder` is RangeEncoder or RangeDecoder.
class IntegerCoder {
 public:
  /// Forgets what was learnt.
  void reset() {
    mixer_.reset();
    last_ = 0;
  }

  /// Codes `value` under a context of the caller's; the values before it are another context.
  /// Decoding, `value` is not used.
  template <class Coder>
  std::int64_t code(Coder& coder, std::int64_t value, std::uint32_t context) {
    const auto bit = [&](std::uint32_t node, bool truth) {
      return mixer_.code(coder, {hash_context(node, context), hash_context(node, 0x10000U + last_)},
                         node < kNodes ? node : 0, truth);
    };
    const auto bits = static_cast<std::uint64_t>(value);
    std::uint64_t size = value < 0 ? ~bits + 1 : bits;
    if (!bit(0, size != 0)) {
      last_ = (last_ * 4) & 63U;
      return 0;
    }
    const bool negative = bit(1, value < 0);
    const auto width = static_cast<std::uint32_t>(std::bit_width(size)) - 1;
    std::uint32_t tree = 1;
    for (int i = 6; i-- > 0;) tree = tree * 2 + (bit(tree + 1, ((width >> i) & 1U) != 0) ? 1U : 0U);
    const std::uint32_t below = tree & 63U;  // bits below the leading one
    std::uint64_t decoded = 1;
    for (std::uint32_t i = 0; i < below; ++i) {
      const bool truth = ((size >> (below - 1 - i)) & 1U) != 0;
      const bool one = i < kModelled
                           ? bit(kNodes + below * 16U + static_cast<std::uint32_t>(decoded), truth)
                           : coder.code(truth, kEven);
      decoded = decoded * 2 + (one ? 1U : 0U);
    }
    last_ = (last_ * 4 + (below < 2 ? 1U : below < 5 ? 2U : 3U)) & 63U;
    return static_cast<std::int64_t>(negative ? ~decoded + 1 : decoded);
  }

 private:
  static constexpr std::uint32_t kNodes = 66;
  static constexpr std::uint32_t kModelled = 3;
  static constexpr std::uint32_t kEven = 32'768;
  BitMixer<2> mixer_{14, kNodes};
  std::uint32_t last_ = 0;  // sizes of the last three values
};

/// Sums and differences modulo 2^64: of numbers that may be anything that bytes announce.
[[nodiscard]] inline std::int64_t wrapped_sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}
[[nodiscard]] inline std::int64_t wrapped_difference(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

/// Codes integers of which a few come again and again, give or take a little: says which of the
/// last different ones is nearest, and what is left.
class RecurrentCoder {
 public:
  void reset() {
    numbers_.reset();
    recent_.fill(0);
    choice_ = 0;
  }

  /// Codes `value`; equal contexts are alike in what is left. Decoding, `value` is not used.
  template <class Coder>
  std::int64_t code(Coder& coder, std::int64_t value, std::uint32_t context) {
    const auto farness = [&](std::int64_t known) {
      const std::int64_t d = wrapped_difference(value, known);
      const auto bits = static_cast<std::uint64_t>(d);
      return d < 0 ? ~bits + 1 : bits;
    };
    const auto nearest =
        std::min_element(recent_.begin(), recent_.end(),
                         [&](std::int64_t a, std::int64_t b) { return farness(a) < farness(b); });
    choice_ = std::clamp<std::int64_t>(
        numbers_.code(coder, nearest - recent_.begin(), static_cast<std::uint32_t>(choice_)), 0,
        static_cast<std::int64_t>(recent_.size()) - 1);
    const auto chosen = recent_.begin() + static_cast<std::ptrdiff_t>(choice_);
    const std::int64_t rest =
        numbers_.code(coder, wrapped_difference(value, *chosen), hash_context(context, 1U));
    const std::int64_t decoded = wrapped_sum(*chosen, rest);
    // The newest first, as it was when it was new; one that is new drives out the oldest.
    const bool known = rest >= -kAlike && rest <= kAlike;
    if (!known) recent_.back() = decoded;
    std::rotate(recent_.begin(), known ? chosen : recent_.end() - 1,
                known ? chosen + 1 : recent_.end());
    return decoded;
  }

 private:
  static constexpr std::int64_t kAlike = 64;
  IntegerCoder numbers_;
  std::array<std::int64_t, 6> recent_{};
  std::int64_t choice_ = 0;
};

}  // namespace sweepcast::beam
