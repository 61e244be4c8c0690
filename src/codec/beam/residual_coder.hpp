// Codes by how many steps a range is off its prediction. One function serves encoder and decoder,
// so that they cannot disagree.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "codec/beam/prediction.hpp"
#include "codec/entropy/mixer.hpp"

namespace sweepcast::beam {

/// Codes a number below 2^24 - 1 in plain bits, fewer for smaller ones: the Elias-gamma code.
template <class Coder>
std::uint32_t code_gamma(Coder& coder, std::uint32_t value) {
  constexpr std::uint32_t kEven = 32768;
  const std::uint32_t plus = value + 1;
  std::uint32_t bits = 0;
  while (bits < 23 && coder.code((plus >> (bits + 1)) != 0, kEven)) ++bits;
  std::uint32_t result = 1;
  for (std::uint32_t i = bits; i-- > 0;) {
    result = result * 2 + (coder.code(((plus >> i) & 1U) != 0, kEven) ? 1U : 0U);
  }
  return result - 1;
}

/// Codes numbers of steps. `kInputs` contexts are mixed: 3, or 4 for fewer bytes. For speed there
/// is QuickResidualCoder.
template <std::size_t kInputs>
class ResidualCoder {
 public:
  /// Forgets everything.
  void reset() {
    zero_.reset();
    sign_.reset();
    magnitude_.reset();
  }
  /// Keeps what was learnt as a first guess for cells of another kind.
  void soften() {
    zero_.soften(kSoft);
    sign_.soften(kSoft);
    magnitude_.soften(kSoft);
  }

  /// Codes `steps` for cell `i` of a run. Decoding: the argument is not used.
  template <class Coder>
  std::int32_t code(Coder& coder, const Contexts& contexts, std::size_t i, std::int32_t basis,
                    std::int32_t steps) {
    Inputs at;
    for (std::size_t k = 0; k < kInputs; ++k) {
      at[k] = static_cast<std::uint32_t>(contexts.of[k][i]);
    }
    const auto mean = static_cast<std::uint32_t>(contexts.mean[i]);
    const auto kind = static_cast<std::uint32_t>(basis);
    if (!zero_.code(coder, at, kind * 8U + mean / 2U, steps != 0)) return 0;

    const BitMixer<2>::Contexts sign_at{
        static_cast<std::uint32_t>(contexts.of[Contexts::direction][i]), at[Contexts::slope] / 11U};
    const bool negative = sign_.code(coder, sign_at, kind, steps < 0);
    const std::int32_t size = code_size(coder, at, mean, negative, steps < 0 ? -steps : steps);
    return negative ? -size : size;
  }

 private:
  static constexpr int kTableBits = 14;
  static constexpr std::uint32_t kUnary = 20;
  static constexpr std::uint16_t kSoft = 16;
  using Inputs = typename BitMixer<kInputs>::Contexts;

  // At least 1: in unary while small, then by the Elias-gamma code.
  template <class Coder>
  std::int32_t code_size(Coder& coder, const Inputs& at, std::uint32_t mean, bool negative,
                         std::int32_t steps) {
    const std::uint32_t sign = negative ? 7'919U : 0U;
    std::int32_t size = 1;
    for (std::uint32_t i = 0; i < kUnary; ++i) {
      const BitMixer<2>::Contexts contexts{i * 16U + mean, at[Contexts::sides] + i * 5'003U + sign};
      if (!magnitude_.code(coder, contexts, i, steps > size)) return size;
      ++size;
    }
    return size + static_cast<std::int32_t>(
                      code_gamma(coder, static_cast<std::uint32_t>(std::max(steps - size, 0))));
  }

  BitMixer<kInputs> zero_{kTableBits, 8 * kBases};
  BitMixer<2> sign_{kTableBits, kBases};
  BitMixer<2> magnitude_{kTableBits, kUnary};
};

}  // namespace sweepcast::beam
