// Codes by how many steps a range is off its prediction, as one symbol where it is few: for speed.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "codec/beam/prediction.hpp"
#include "codec/entropy/symbol_coder.hpp"

namespace sweepcast::beam {

/// The quick twin of ResidualCoder.
class QuickResidualCoder {
 public:
  /// Forgets everything.
  void reset() {
    small_.reset(kFirst);
    large_.reset(kFirst);
  }
  /// Keeps what was learnt as a first guess for cells of another kind.
  void soften() {
    small_.soften(kSoft);
    large_.soften(kSoft);
  }

  /// Codes `steps` for cell `i` of a run. Decoding: the argument is not used.
  template <class Coder>
  std::int32_t code(Coder& coder, const Contexts& contexts, std::size_t i, std::int32_t /*basis*/,
                    std::int32_t steps) {
    // As the cell across says: away from it, or towards it.
    const auto context = static_cast<std::uint32_t>(contexts.of[Contexts::trust][i]);
    const std::int32_t turned = contexts.turned[i];
    const std::int32_t towards = (steps ^ -turned) + turned;
    const auto folded = static_cast<std::uint32_t>((towards * 2) ^ (towards >> 31));
    std::uint32_t symbol = small_.code(coder, context, std::min(folded, kLarge));
    if (symbol == kLarge)
      symbol += code_large(coder, context % 16U, folded - std::min(folded, kLarge));
    const auto unfolded = static_cast<std::int32_t>((symbol >> 1) ^ (0U - (symbol & 1U)));
    return (unfolded ^ -turned) + turned;
  }

 private:
  static constexpr std::uint32_t kLarge = 15;
  static constexpr std::uint16_t kSoft = 16;

  // Its number of bits as a symbol (15 and more alike), then the bits.
  template <class Coder>
  std::uint32_t code_large(Coder& coder, std::uint32_t context, std::uint32_t value) {
    constexpr std::uint32_t kEven = 32'768;
    constexpr std::uint32_t kMostBits = 24;
    const std::uint32_t plus = value + 1;
    const auto below = static_cast<std::uint32_t>(std::bit_width(plus)) - 1;
    std::uint32_t bits = large_.code(coder, context, std::min(below, kLarge));
    while (bits >= kLarge && bits < kMostBits && coder.code(below > bits, kEven)) ++bits;
    std::uint32_t result = 1;
    for (std::uint32_t i = bits; i-- > 0;) {
      result = result * 2 + (coder.code(((plus >> i) & 1U) != 0, kEven) ? 1U : 0U);
    }
    return result - 1;
  }

  static constexpr SymbolShares kFirst = [] {
    SymbolShares shares{};
    int share = 10'000;
    int at = 0;
    for (std::size_t k = 0; k < kSymbols; ++k) {
      shares.from[k] = static_cast<std::int16_t>(at);
      at += std::max(share, 200);
      share = share * 2 / 3;
    }
    return shares;
  }();

  SymbolCoder small_{960};
  SymbolCoder large_{16};
};

}  // namespace sweepcast::beam
