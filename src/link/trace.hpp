// What a link can carry, by time: traces that were recorded, and schedules that were written down.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sweepcast/status.hpp"

namespace sweepcast {

/// Bytes that an opportunity of a trace carries, as mahimahi defines it.
inline constexpr std::int64_t kOpportunityBytes = 1500;

/// Opportunities to send, each of `kOpportunityBytes`; they repeat after `period_us` for ever.
struct Trace {
  std::string name;  ///< of the file without its folder, or "paper"
  /// Microseconds from the start, in order, none negative, at least one, the last at most
  /// `period_us`; equal times are several opportunities at once.
  std::vector<std::int64_t> opportunities_us;
  std::int64_t period_us = 0;  ///< above 0; the next round begins then
};

/// Reads a trace of the mahimahi project: a line an opportunity, whole milliseconds from the start,
/// never less than the line before. The next round begins at the last opportunity.
/// Errors: corrupt (what is no such number, with its line; time running backwards), limit (a trace
/// of over a day), truncated (no line, or no time passes).
[[nodiscard]] Result<Trace> parse_mahimahi(std::string_view text, std::string name);

/// Reads a schedule: lines of a time in seconds and the kilobytes (1000 bytes) a second from then
/// on, the first at time 0; last the time of its end and the word "end". `#` begins a comment. An
/// opportunity is where another 1500 bytes have come together.
/// Errors: as of `parse_mahimahi`; limit also where a rate is over 1 GB/s or it is over 10^8
/// opportunities; truncated also without the line "end".
[[nodiscard]] Result<Trace> parse_schedule(std::string_view text, std::string name);

/// The experiment of the RCPCC paper, section IV.D: 300 KB/s, from 55 s on 100, from 120 s on 130,
/// from 245 s on 160. Its end is not told there; 300 s here.
[[nodiscard]] Trace paper_trace();

/// Reads a file: a schedule where its name ends in ".schedule", else a mahimahi trace. "paper"
/// stands for `paper_trace`, unless there is a file of that name.
/// Errors: those of the readers, with the file's name; not_found, io, limit (over 256 MB).
[[nodiscard]] Result<Trace> read_trace(const std::filesystem::path& file);

/// Bytes that the trace offers in each of the first seconds, for as many as are asked for.
[[nodiscard]] std::vector<std::int64_t> bytes_per_second(const Trace& trace, std::size_t seconds);

}  // namespace sweepcast
