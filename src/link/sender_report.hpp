// A sender's reports of itself, twice a second. docs/format-link.md has the bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/bytes.hpp"
#include "sweepcast/link.hpp"

namespace sweepcast::link {

inline constexpr std::int64_t kSenderReportInterval_us = 500'000;

/// `number` counts a connection's reports, from 1: those that come late are left out.
void write_sender_report(std::uint32_t number, const SenderReport& report,
                         std::vector<std::byte>& plain);

struct NumberedSenderReport {
  std::uint32_t number = 0;
  SenderReport report;
};
/// None where a number or the size is out of bounds, or what is told contradicts itself.
[[nodiscard]] std::optional<NumberedSenderReport> read_sender_report(
    std::span<const std::byte> plain);

/// A level as one byte; 255 is none.
void put_level(ByteWriter& out, std::optional<std::size_t> level);
/// False where it is no level.
[[nodiscard]] bool get_level(ByteReader& in, std::optional<std::size_t>& level);

}  // namespace sweepcast::link
