// Random numbers for tests that are the same with every standard library.
#pragma once

#include <cstdint>
#include <random>

namespace sweepcast::test {

/// 32 random bits.
inline std::uint32_t random_bits(std::mt19937& random) {
  return static_cast<std::uint32_t>(random());
}

/// A number from [low, high).
inline double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * (random_bits(random) / 4294967296.0);
}

/// An integer from [low, high].
inline int uniform_int(std::mt19937& random, int low, int high) {
  return low + static_cast<int>(random_bits(random) % static_cast<std::uint32_t>(high - low + 1));
}

}  // namespace sweepcast::test
