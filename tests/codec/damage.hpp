// Damage as it is done to frames and their parts, in tests of what decoders make of it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "core/random.hpp"

namespace sweepcast::test {

/// One to four flips, changed bytes, insertions, deletions, or splices with the end of one of the
/// `others`; half of them within the first 300 bytes, where heads and sizes are.
inline void mutate(std::mt19937& random, std::span<const std::vector<std::byte>> others,
                   std::vector<std::byte>& bytes) {
  for (int n = uniform_int(random, 1, 4); n > 0 && !bytes.empty(); --n) {
    const auto size = static_cast<int>(bytes.size());
    const int last = random_bits(random) % 2 == 0 ? size - 1 : std::min(size - 1, 300);
    const auto at = bytes.begin() + uniform_int(random, 0, last);
    switch (random_bits(random) % 5) {
      case 0:
        *at ^= static_cast<std::byte>(1U << (random_bits(random) % 8));
        break;
      case 1:
        *at = static_cast<std::byte>(random_bits(random));
        break;
      case 2:
        bytes.insert(at, static_cast<std::size_t>(uniform_int(random, 1, 9)),
                     static_cast<std::byte>(random_bits(random)));
        break;
      case 3:
        bytes.erase(at,
                    at + std::min<std::ptrdiff_t>(bytes.end() - at, uniform_int(random, 1, 30)));
        break;
      default: {
        const auto& other = others[random_bits(random) % others.size()];
        const auto from = uniform_int(random, 0, static_cast<int>(other.size()));
        bytes.erase(at, bytes.end());
        bytes.insert(bytes.end(), other.begin() + from, other.end());
      }
    }
  }
}

}  // namespace sweepcast::test
