#include "link/sender_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rate/qoe.hpp"

namespace sweepcast::link {
namespace {

constexpr std::uint8_t kNoLevel = 255;
constexpr std::uint8_t kCanOverride = 1;  // flags
constexpr std::int32_t kNoQoe = std::numeric_limits<std::int32_t>::min();
constexpr double kQoeUnits = 1000.0;
constexpr double kMostQoe = 1e6;

/// What does not fit is as large as can be told.
template <class T>
T limited(std::size_t value) {
  return static_cast<T>(std::min<std::size_t>(value, std::numeric_limits<T>::max()));
}

std::int32_t qoe_units(std::optional<double> qoe) {
  if (!qoe || !std::isfinite(*qoe)) return kNoQoe;
  return static_cast<std::int32_t>(std::lround(std::clamp(*qoe, -kMostQoe, kMostQoe) * kQoeUnits));
}

}  // namespace

void put_level(ByteWriter& out, std::optional<std::size_t> level) {
  out.put(level && *level < kLevels ? static_cast<std::uint8_t>(*level) : kNoLevel);
}

bool get_level(ByteReader& in, std::optional<std::size_t>& level) {
  const auto byte = in.get<std::uint8_t>();
  if (!in.ok() || (byte >= kLevels && byte != kNoLevel)) return false;
  level = byte == kNoLevel ? std::nullopt : std::optional<std::size_t>(byte);
  return true;
}

void write_sender_report(std::uint32_t number, const SenderReport& report,
                         std::vector<std::byte>& plain) {
  plain.clear();
  ByteWriter out(plain);
  out.put(number);
  out.put(report.can_override ? kCanOverride : std::uint8_t{0});
  put_level(out, report.level);
  put_level(out, report.override_level);
  out.put(limited<std::uint16_t>(report.queued_frames));
  out.put(limited<std::uint32_t>(report.queued_bytes));
  out.put(report.sweeps);
  out.put(report.sent);
  out.put(report.cut);
  out.put(report.dropped);
  out.put(qoe_units(report.qoe));
}

std::optional<NumberedSenderReport> read_sender_report(std::span<const std::byte> plain) {
  ByteReader in(plain);
  NumberedSenderReport out;
  SenderReport& report = out.report;
  out.number = in.get<std::uint32_t>();
  const auto flags = in.get<std::uint8_t>();
  report.can_override = (flags & kCanOverride) != 0;
  const bool has_levels = get_level(in, report.level) && get_level(in, report.override_level);
  report.queued_frames = in.get<std::uint16_t>();
  report.queued_bytes = in.get<std::uint32_t>();
  report.sweeps = in.get<std::uint64_t>();
  report.sent = in.get<std::uint64_t>();
  report.cut = in.get<std::uint64_t>();
  report.dropped = in.get<std::uint64_t>();
  const auto qoe = in.get<std::int32_t>();
  if (qoe != kNoQoe) report.qoe = static_cast<double>(qoe) / kQoeUnits;
  const bool is_sound = has_levels && flags <= kCanOverride && out.number > 0 &&
                        (report.can_override || !report.override_level);
  if (!in.ok() || !in.at_end() || !is_sound) return std::nullopt;
  return out;
}

}  // namespace sweepcast::link
