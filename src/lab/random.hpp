// Random numbers that are the same on every machine: integers by hashing a counter, and from them
// doubles by exact operations. The standard library leaves its distributions to the vendor.
#pragma once

#include <cstdint>

namespace sweepcast::lab {

/// SplitMix64's finaliser (Steele, Lea, Flood 2014): a bijection that scatters every bit.
constexpr std::uint64_t scatter(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

/// A stream of numbers that its key determines. Streams of different keys are independent, so that
/// a ray's noise depends on the ray alone and not on who is cast first. Draw at most one number in
/// the arguments of a call: compilers evaluate those in orders of their own.
class Random {
 public:
  constexpr explicit Random(std::uint64_t seed, std::uint64_t a = 0, std::uint64_t b = 0,
                            std::uint64_t c = 0)
      : state_(scatter(scatter(scatter(scatter(seed + kStep) + a) + b * kStep) + c)) {}

  constexpr std::uint64_t bits() { return scatter(state_ += kStep); }
  /// In [0, 1), a multiple of 2^-53.
  constexpr double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In [0, count).
  constexpr int below(int count) { return static_cast<int>(uniform() * count); }
  constexpr bool chance(double probability) { return uniform() < probability; }
  /// Standard normal, by the sum of twelve uniforms (Irwin-Hall): never beyond 6.
  constexpr double normal() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

 private:
  static constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15ULL;
  std::uint64_t state_;
};

}  // namespace sweepcast::lab
