// Floats as integers that rise with them, so that those near each other have near numbers.
#pragma once

#include <bit>
#include <cstdint>

namespace sweepcast::beam {

/// The bits of `value`, negative ones turned over, and the sign's bit.
[[nodiscard]] inline std::uint32_t ordered_bits(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits >> 31) != 0 ? ~bits : bits | 0x80000000U;
}

/// Undoes `ordered_bits`.
[[nodiscard]] inline float float_of_ordered(std::uint32_t ordered) {
  return std::bit_cast<float>((ordered >> 31) != 0 ? ordered & 0x7FFFFFFFU : ~ordered);
}

}  // namespace sweepcast::beam
