// An adaptive probability of a bit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace sweepcast {

/// A probability of a 1, in 1/65536, and how often it has learnt. The first bits are followed fast,
/// later ones slowly.
struct Slot {
  static constexpr std::size_t kMostSeen = 255;

  std::uint16_t p = 32768;
  std::uint16_t count = 0;

  void learn(bool bit) {
    const int target = bit ? 65535 : 0;
    p = static_cast<std::uint16_t>(static_cast<int>(p) +
                                   (((target - static_cast<int>(p)) * int{kRates[count]}) >> 16));
    if (count < kMostSeen) ++count;
  }

 private:
  static constexpr auto kRates = [] {
    std::array<std::uint16_t, kMostSeen + 1> rates{};
    for (std::size_t n = 0; n <= kMostSeen; ++n) {
      rates[n] = static_cast<std::uint16_t>(65536.0 / (static_cast<double>(n) + 1.8));
    }
    return rates;
  }();
};

}  // namespace sweepcast
