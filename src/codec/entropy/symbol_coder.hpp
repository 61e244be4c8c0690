// Adaptive probabilities of symbols from 0 to 15, for a range coder: one step where a tree of bits
// would take four.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/entropy/range_coder.hpp"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace sweepcast {

inline constexpr std::size_t kSymbols = 16;
inline constexpr int kShareBits = 15;

/// Where the symbols' shares of 2^15 begin: rising, from 0.
struct alignas(16) SymbolShares {
  std::array<std::int16_t, kSymbols> from{};

  /// The same in units of a range's `width`.
  [[nodiscard]] std::uint32_t begin(std::size_t symbol, std::uint32_t width) const {
    return (width * static_cast<std::uint32_t>(from[symbol])) >> kShareBits;
  }
};

/// The two ways to compute the same; SymbolCoder takes the one that the target has.
namespace plain {

/// The last symbol whose part of `width` begins at or below `place`; both are below 2^16.
[[nodiscard]] inline std::uint32_t find_symbol(const SymbolShares& shares, std::uint32_t width,
                                               std::uint32_t place) {
  std::uint32_t symbol = 0;
  for (std::size_t k = 1; k < kSymbols; ++k) symbol += shares.begin(k, width) <= place ? 1U : 0U;
  return symbol;
}

/// Brings shares nearer to others, by 1 / 2^rate of the way.
inline void approach(const SymbolShares& target, int rate, SymbolShares& shares) {
  for (std::size_t k = 0; k < kSymbols; ++k) {
    const int apart = target.from[k] - shares.from[k];
    shares.from[k] = static_cast<std::int16_t>(shares.from[k] + (apart >> rate));
  }
}

}  // namespace plain

#if defined(__SSE2__)
namespace sse2 {

[[nodiscard]] inline std::uint32_t find_symbol(const SymbolShares& shares, std::uint32_t width,
                                               std::uint32_t place) {
  const __m128i widths = _mm_set1_epi16(static_cast<std::int16_t>(width));
  const __m128i places = _mm_set1_epi16(static_cast<std::int16_t>(place));
  const auto begun = [&](std::size_t first) {
    const auto* lanes = reinterpret_cast<const __m128i*>(shares.from.data() + first);
    const __m128i begin = _mm_mulhi_epu16(_mm_slli_epi16(_mm_load_si128(lanes), 1), widths);
    return _mm_cmpeq_epi16(_mm_subs_epu16(begin, places), _mm_setzero_si128());
  };
  const int ones = _mm_movemask_epi8(_mm_packs_epi16(begun(0), begun(8)));
  return range_detail::floor_log2(static_cast<std::uint32_t>(ones));
}

inline void approach(const SymbolShares& target, int rate, SymbolShares& shares) {
  const __m128i shift = _mm_cvtsi32_si128(rate);
  for (std::size_t first = 0; first < kSymbols; first += 8) {
    const auto* to = reinterpret_cast<const __m128i*>(target.from.data() + first);
    auto* lanes = reinterpret_cast<__m128i*>(shares.from.data() + first);
    const __m128i now = _mm_load_si128(lanes);
    const __m128i apart = _mm_sub_epi16(_mm_load_si128(to), now);
    _mm_store_si128(lanes, _mm_add_epi16(now, _mm_sra_epi16(apart, shift)));
  }
}

}  // namespace sse2
namespace symbol_detail = sse2;
#else
namespace symbol_detail = plain;
#endif

/// Codes symbols under contexts, each of which learns by itself: its first symbols fast.
class SymbolCoder {
 public:
  explicit SymbolCoder(std::size_t contexts) : shares_(contexts), counts_(contexts) {}

  /// Forgets everything, for the next sweep: every context begins with these shares.
  void reset(const SymbolShares& first) {
    std::fill(shares_.begin(), shares_.end(), first);
    std::fill(counts_.begin(), counts_.end(), std::uint16_t{0});
  }

  /// Lets what was learnt be overruled fast, as if no context had learnt more than `most` symbols.
  void soften(std::uint16_t most) {
    for (std::uint16_t& count : counts_) count = std::min(count, most);
  }

  /// Codes a symbol through `coder` (a RangeEncoder or RangeDecoder); returns it. Decoding, the
  /// argument is not used.
  template <class Coder>
  std::uint32_t code(Coder& coder, std::size_t context, std::uint32_t symbol) {
    SymbolShares& shares = shares_[context];
    const std::uint32_t width = coder.width();
    if constexpr (kDecodes<Coder>) {
      symbol = symbol_detail::find_symbol(shares, width, coder.place());
    }
    const bool last = symbol == kSymbols - 1;
    coder.narrow(shares.begin(symbol, width), last ? 0 : shares.begin(symbol + 1, width));
    std::uint16_t& count = counts_[context];
    symbol_detail::approach(kTargets[symbol], kRates[count], shares);
    if (count + 1U < kRates.size()) ++count;
    return symbol;
  }

 private:
  static constexpr int kLeastShare = 16;  ///< learning makes no share smaller

  // All that one symbol can have.
  static constexpr auto kTargets = [] {
    constexpr int kLast = int{kSymbols};
    std::array<SymbolShares, kSymbols> targets{};
    for (int symbol = 0; symbol < kLast; ++symbol) {
      for (int k = 0; k < kLast; ++k) {
        targets[static_cast<std::size_t>(symbol)].from[static_cast<std::size_t>(k)] =
            static_cast<std::int16_t>(k > symbol ? (1 << kShareBits) - kLeastShare * (kLast - k)
                                                 : kLeastShare * k);
      }
    }
    return targets;
  }();
  static constexpr auto kRates = [] {
    std::array<std::uint8_t, 41> rates{};
    for (std::size_t n = 0; n < rates.size(); ++n) {
      rates[n] = n < 2 ? 2 : n < 6 ? 3 : n < 15 ? 4 : n < 40 ? 5 : 6;
    }
    return rates;
  }();

  std::vector<SymbolShares> shares_;
  std::vector<std::uint16_t> counts_;  ///< of symbols learnt
};

}  // namespace sweepcast
