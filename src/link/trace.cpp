#include "link/trace.hpp"

#include <cmath>
#include <optional>
#include <span>
#include <system_error>

#include "io/file.hpp"
#include "io/text.hpp"

namespace sweepcast {
namespace {

constexpr std::size_t kFileCap = std::size_t{256} << 20;
constexpr std::int64_t kLongestTraceUs = 86'400'000'000;
constexpr double kMostOpportunities = 1e7;
constexpr double kMostKilobytes = 1e6;  ///< a second

tl::unexpected<Error> fail_at(ErrorCode code, std::size_t line, const std::string& what) {
  return fail(code, "line " + std::to_string(line) + ": " + what);
}

/// Adds the opportunities of a stretch of a schedule. `left` is what the stretch before left of an
/// opportunity, in bytes times microseconds a second, and is given on.
void add_stretch(std::int64_t begin_us, std::int64_t end_us, std::int64_t bytes_per_s,
                 std::int64_t& left, std::vector<std::int64_t>& opportunities_us) {
  constexpr std::int64_t kWhole = kOpportunityBytes * 1'000'000;
  const std::int64_t offered = left + bytes_per_s * (end_us - begin_us);
  for (std::int64_t k = 1; k * kWhole <= offered; ++k) {
    const std::int64_t wait = (k * kWhole - left + bytes_per_s - 1) / bytes_per_s;
    opportunities_us.push_back(begin_us + wait);
  }
  left = offered % kWhole;
}

/// A line of a schedule.
struct Entry {
  std::int64_t from_us = 0;
  std::optional<double> kilobytes;  ///< a second; none at the end
};

Result<Entry> parse_entry(std::string_view line, std::size_t number) {
  const auto seconds = number_of<double>(next_word(line));
  const std::string_view rate_word = next_word(line);
  const auto rate = number_of<double>(rate_word);
  const bool sound = seconds && *seconds >= 0.0 && (rate_word == "end" || (rate && *rate >= 0.0)) &&
                     next_word(line).empty();
  if (!sound) {
    return fail_at(ErrorCode::corrupt, number,
                   "no schedule; a line has seconds and kilobytes a second, the last one seconds "
                   "and the word end");
  }
  if (*seconds * 1e6 > static_cast<double>(kLongestTraceUs) || (rate && *rate > kMostKilobytes)) {
    return fail_at(ErrorCode::limit, number, "over a day, or over 1 GB/s; make it smaller");
  }
  return Entry{std::llround(*seconds * 1e6), rate};
}

}  // namespace

Result<Trace> parse_mahimahi(std::string_view text, std::string name) {
  Trace trace{std::move(name), {}, 0};
  LineReader lines(text);
  while (auto line = lines.next()) {
    const std::string_view word = next_word(*line);
    if (word.empty()) continue;
    const auto ms = number_of<std::int64_t>(word);
    if (!ms || *ms < 0 || !next_word(*line).empty()) {
      return fail_at(ErrorCode::corrupt, lines.line(),
                     "no trace; a line has one whole number of milliseconds");
    }
    if (*ms > kLongestTraceUs / 1000) {
      return fail_at(ErrorCode::limit, lines.line(), "later than a day; cut the trace");
    }
    if (*ms * 1000 < trace.period_us) {
      return fail_at(ErrorCode::corrupt, lines.line(), "earlier than the line before; sort them");
    }
    trace.period_us = *ms * 1000;
    trace.opportunities_us.push_back(trace.period_us);
  }
  if (trace.period_us == 0) {
    return fail(ErrorCode::truncated, "no time passes in this trace; give one that lasts");
  }
  return trace;
}

Result<Trace> parse_schedule(std::string_view text, std::string name) {
  Trace trace{std::move(name), {}, 0};
  LineReader lines(text);
  Entry now;  // no line yet: a schedule begins with a rate
  std::int64_t left = 0;
  bool begun = false;
  while (auto line = lines.next()) {
    std::string_view words = line->substr(0, line->find('#'));
    if (std::string_view rest = words; next_word(rest).empty()) continue;
    const auto entry = parse_entry(words, lines.line());
    if (!entry) return tl::unexpected(entry.error());
    if (begun ? entry->from_us <= now.from_us || !now.kilobytes
              : entry->from_us != 0 || !entry->kilobytes) {
      return fail_at(ErrorCode::corrupt, lines.line(),
                     "out of order; times rise from 0, and nothing follows the end");
    }
    if (begun) {
      const double bytes_per_s = std::round(*now.kilobytes * 1e3);
      const double bytes = bytes_per_s * static_cast<double>(entry->from_us - now.from_us) * 1e-6;
      if (static_cast<double>(trace.opportunities_us.size()) + bytes / kOpportunityBytes >
          kMostOpportunities) {
        return fail_at(ErrorCode::limit, lines.line(), "too much data; make it shorter");
      }
      add_stretch(now.from_us, entry->from_us, static_cast<std::int64_t>(bytes_per_s), left,
                  trace.opportunities_us);
    }
    begun = true;
    now = *entry;
  }
  if (!begun || now.kilobytes) {
    return fail(ErrorCode::truncated, "the schedule has no end; add a line as in \"300 end\"");
  }
  if (trace.opportunities_us.empty()) {
    return fail(ErrorCode::truncated, "nothing can be sent in this schedule; give it a rate");
  }
  trace.period_us = now.from_us;
  return trace;
}

Trace paper_trace() {
  return *parse_schedule("0 300\n55 100\n120 130\n245 160\n300 end\n", "paper");
}

Result<Trace> read_trace(const std::filesystem::path& file) {
  std::error_code ignored;
  if (file == "paper" && !std::filesystem::exists(file, ignored)) return paper_trace();
  std::vector<std::byte> bytes;
  if (const Status read = read_file(file, kFileCap, bytes); !read) {
    return tl::unexpected(read.error());
  }
  const auto parse = file.extension() == ".schedule" ? parse_schedule : parse_mahimahi;
  auto trace = parse(as_text(bytes), file.filename().string());
  if (!trace) return fail(trace.error().code, file.string() + ": " + trace.error().message);
  return trace;
}

std::vector<std::int64_t> bytes_per_second(const Trace& trace, std::size_t seconds) {
  std::vector<std::int64_t> bytes(seconds, 0);
  if (seconds == 0) return bytes;
  const auto end_us = static_cast<std::int64_t>(seconds) * 1'000'000;
  for (std::int64_t round_us = 0; round_us < end_us; round_us += trace.period_us) {
    for (const std::int64_t time_us : trace.opportunities_us) {
      const std::int64_t at_us = round_us + time_us;
      if (at_us >= end_us) break;
      bytes[static_cast<std::size_t>(at_us / 1'000'000)] += kOpportunityBytes;
    }
  }
  return bytes;
}

}  // namespace sweepcast
