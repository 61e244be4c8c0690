// Small integers as bytes, in the form that zstd's entropy stage packs best: one byte for nearly
// every symbol, an escape for the rest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/bytes.hpp"

namespace sweepcast::rcpcc {

inline constexpr std::uint8_t kEscape = 255;
inline constexpr std::int32_t kLargestRange = 2'000'000;  ///< millimetres; any sensor sees less

/// 0 to 254 as one byte; more as 255 and a varint of the excess.
inline void put_count(ByteWriter& out, std::uint32_t value) {
  if (value < kEscape) {
    out.put(static_cast<std::uint8_t>(value));
  } else {
    out.put(kEscape);
    out.put_varint(value - kEscape);
  }
}

/// A signed value by its zigzag map: 0, -1, 1, -2, ... as 0, 1, 2, 3, ...
inline void put_value(ByteWriter& out, std::int32_t value) {
  put_count(out,
            (static_cast<std::uint32_t>(value) << 1) ^ static_cast<std::uint32_t>(value >> 31));
}

[[nodiscard]] inline std::uint32_t get_count(ByteReader& in) {
  const auto byte = in.get<std::uint8_t>();
  if (byte != kEscape) return byte;
  return static_cast<std::uint32_t>(kEscape + in.get_varint(0xFFFFFFFFU - kEscape));
}

[[nodiscard]] inline std::int32_t get_value(ByteReader& in) {
  const std::uint32_t bits = get_count(in);
  return static_cast<std::int32_t>((bits >> 1) ^ (~(bits & 1U) + 1U));
}

}  // namespace sweepcast::rcpcc
