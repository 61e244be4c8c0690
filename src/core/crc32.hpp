// CRC-32 (ISO 3309, the polynomial of zlib and PNG): finds damage, does not authenticate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace sweepcast {

[[nodiscard]] std::uint32_t crc32(std::span<const std::byte> bytes) noexcept;

}  // namespace sweepcast
