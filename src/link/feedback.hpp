// Feedback: what a receiver tells a sender every 50 ms. docs/format-link.md has the bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "link/fragment.hpp"
#include "sweepcast/link.hpp"

namespace sweepcast::link {

inline constexpr Microseconds kReportInterval = 50'000;

/// What became of a stream's newest sweep that is over.
struct StreamReport {
  std::uint8_t stream = 0;
  std::uint8_t layers = 0;  ///< whole ones that arrived
  std::uint32_t sweep = 0;
  std::uint32_t model = 0;  ///< crc32 of the sensor's model that the receiver holds; 0: none
};

/// What an operator asks for: a level, or, with none, what the sender's strategy chooses.
struct LevelWish {
  std::optional<std::size_t> level;

  [[nodiscard]] bool operator==(const LevelWish&) const = default;
};

/// One report. Times are microseconds, 32 bits.
struct Report {
  std::uint32_t number = 0;   ///< counts a connection's reports, from 1
  std::uint32_t now_us = 0;   ///< the receiver's clock
  std::uint32_t echo_us = 0;  ///< `Fragment::sent_us` of the newest fragment
  std::uint32_t held_us = 0;  ///< since that one arrived
  std::uint32_t least_delay_us =
      0;                        ///< receiver's less sender's clock, least since the last report
  std::uint32_t fragments = 0;  ///< since the last report
  std::uint64_t bytes = 0;      ///< of packets, since the connection began
  std::uint32_t busy_us = 0;    ///< see `ArrivalMeter`
  std::uint32_t busy_bytes = 0;
  std::vector<StreamReport> streams;
  std::optional<LevelWish> wish;  ///< only to senders whose own reports said that they obey
};

void write_report(const Report& report, std::vector<std::byte>& plain);
/// None where a number or the size is out of bounds.
[[nodiscard]] std::optional<Report> read_report(std::span<const std::byte> plain);

/// What the link carried, since it was last asked.
struct LinkSample {
  std::size_t bytes = 0;
  double busy_s = 0.0;
};

/// Turns the reports of a connection into what a strategy sees.
class LinkObserver {
 public:
  /// False where the report is older than one before and was left out.
  bool add(const Report& report, Microseconds now);
  /// As of `now`; `queued_bytes` is left to the caller.
  [[nodiscard]] LinkState state(Microseconds now) const;
  [[nodiscard]] LinkSample take_sample();

 private:
  LinkState state_;
  LinkSample sample_;
  Microseconds last_at_ = 0;
  std::optional<Report> last_;
  /// Least delays of spans of 10 s, relative to the first report's: now and before.
  std::int64_t least_now_ = 0, least_before_ = 0;
  Microseconds span_began_ = 0;
  std::array<double, 40> trips_s_{};  ///< round trips of the last 2 s
  std::size_t number_of_trips_ = 0;
  std::uint32_t reference_us_ = 0;
};

}  // namespace sweepcast::link
