// Makes the checksums of a damaged frame right again, so that the damage gets past them to the
// parsers behind.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/bytes.hpp"
#include "core/crc32.hpp"
#include "sweepcast/frame.hpp"

namespace sweepcast::fuzz {

inline void put_checksum(std::span<std::byte> frame, std::size_t at, std::uint32_t checksum) {
  for (std::size_t i = 0; i < 4; ++i) frame[at + i] = static_cast<std::byte>(checksum >> (8 * i));
}

/// Walks the head as docs/format.md has it; leaves the frame alone where that leads nowhere.
inline void repair_checksums(std::span<std::byte> frame) {
  ByteReader in(frame);
  (void)in.get<std::uint32_t>();  // magic
  (void)in.get<std::uint8_t>();   // version
  const auto codec = static_cast<CodecId>(in.get<std::uint8_t>());
  const std::size_t counts = codec == CodecId::beam ? 8 : 7;
  (void)in.get_varint();         // sequence
  (void)in.get<std::int64_t>();  // stamp
  (void)in.get_text();           // sensor
  for (std::size_t i = 0; i < counts; ++i) (void)in.get_varint();
  struct Part {
    std::size_t checksum_at, size;
  };
  std::vector<Part> parts(in.get_varint(64));
  for (Part& part : parts) {
    (void)in.get<std::uint8_t>();  // kind
    part.size = in.get_varint();
    part.checksum_at = in.position();
    (void)in.get<std::uint32_t>();
  }
  const std::size_t head_checksum_at = in.position();
  (void)in.get<std::uint32_t>();
  if (!in.ok()) return;
  for (const Part& part : parts) {
    const auto bytes = in.get_bytes(part.size);
    if (!in.ok()) break;  // this part is cut short, and the rest with it
    put_checksum(frame, part.checksum_at, crc32(bytes));
  }
  put_checksum(frame, head_checksum_at, crc32(frame.first(head_checksum_at)));
}

}  // namespace sweepcast::fuzz
