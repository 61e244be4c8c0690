// A checksum before the bytes of a library that does not survive damage.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/bytes.hpp"
#include "core/crc32.hpp"

namespace sweepcast::lab {

/// Makes `frame` of the checksum, 4 bytes, and `body`.
inline void write_checked(std::span<const std::byte> body, std::vector<std::byte>& frame) {
  frame.clear();
  ByteWriter writer(frame);
  writer.put(crc32(body));
  writer.put_bytes(body);
}

/// The body of a frame; none where the checksum does not match.
[[nodiscard]] inline std::optional<std::span<const std::byte>> read_checked(
    std::span<const std::byte> frame) {
  ByteReader reader(frame);
  const auto checksum = reader.get<std::uint32_t>();
  const auto body = reader.get_bytes(reader.remaining());
  if (!reader.ok() || crc32(body) != checksum) return std::nullopt;
  return body;
}

}  // namespace sweepcast::lab
