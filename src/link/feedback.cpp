#include "link/feedback.hpp"

#include <algorithm>
#include <utility>

#include "core/bytes.hpp"
#include "link/sender_report.hpp"

namespace sweepcast::link {

void write_report(const Report& report, std::vector<std::byte>& plain) {
  plain.clear();
  ByteWriter out(plain);
  out.put(report.number);
  out.put(report.now_us);
  out.put(report.echo_us);
  out.put(report.held_us);
  out.put(report.least_delay_us);
  out.put(report.fragments);
  out.put(report.bytes);
  out.put(report.busy_us);
  out.put(report.busy_bytes);
  out.put(static_cast<std::uint8_t>(report.streams.size()));
  for (const StreamReport& stream : report.streams) {
    out.put(stream.stream);
    out.put(stream.layers);
    out.put(stream.sweep);
    out.put(stream.model);
  }
  if (report.wish) put_level(out, report.wish->level);
}

std::optional<Report> read_report(std::span<const std::byte> plain) {
  ByteReader in(plain);
  Report report;
  report.number = in.get<std::uint32_t>();
  report.now_us = in.get<std::uint32_t>();
  report.echo_us = in.get<std::uint32_t>();
  report.held_us = in.get<std::uint32_t>();
  report.least_delay_us = in.get<std::uint32_t>();
  report.fragments = in.get<std::uint32_t>();
  report.bytes = in.get<std::uint64_t>();
  report.busy_us = in.get<std::uint32_t>();
  report.busy_bytes = in.get<std::uint32_t>();
  const auto streams = in.get<std::uint8_t>();
  if (!in.ok() || streams > kMostStreams) return std::nullopt;
  for (std::uint8_t i = 0; i < streams; ++i) {
    StreamReport stream;
    stream.stream = in.get<std::uint8_t>();
    stream.layers = in.get<std::uint8_t>();
    stream.sweep = in.get<std::uint32_t>();
    stream.model = in.get<std::uint32_t>();
    if (stream.stream >= kMostStreams) return std::nullopt;
    report.streams.push_back(stream);
  }
  if (in.ok() && !in.at_end()) {
    LevelWish wish;
    if (!get_level(in, wish.level)) return std::nullopt;
    report.wish = wish;
  }
  if (!in.ok() || !in.at_end()) return std::nullopt;
  return report;
}

bool LinkObserver::add(const Report& report, Microseconds now) {
  constexpr Microseconds kSpan = 10'000'000;
  if (last_ && report.number <= last_->number) return false;
  if (!last_ && report.fragments == 0) return true;  // nothing to measure yet
  if (last_) {
    sample_.bytes += report.busy_bytes - last_->busy_bytes;
    sample_.busy_s += static_cast<double>(report.busy_us - last_->busy_us) * 1e-6;
    const std::int32_t elapsed = wrapped_difference(report.now_us, last_->now_us);
    if (elapsed > 0 && report.bytes >= last_->bytes) {
      state_.receive_rate =
          static_cast<double>(report.bytes - last_->bytes) * 1e6 / static_cast<double>(elapsed);
    }
  } else {
    reference_us_ = report.least_delay_us;
    span_began_ = now;
  }
  if (report.fragments > 0) {
    const std::int64_t delay = wrapped_difference(report.least_delay_us, reference_us_);
    if (now - span_began_ > kSpan) {
      least_before_ = least_now_;
      least_now_ = delay;
      span_began_ = now;
    }
    least_now_ = std::min(least_now_, delay);
    const std::int64_t least = std::min(least_now_, least_before_);
    state_.queue_delay_s = static_cast<double>(delay - least) * 1e-6;
    const auto sent = static_cast<std::uint32_t>(now);
    const std::int32_t round = wrapped_difference(sent, report.echo_us);
    state_.round_trip_s =
        std::max(0.0, (static_cast<double>(round) - static_cast<double>(report.held_us)) * 1e-6);
    trips_s_[number_of_trips_++ % trips_s_.size()] = state_.round_trip_s;
    const auto end =
        trips_s_.begin() + static_cast<std::ptrdiff_t>(std::min(number_of_trips_, trips_s_.size()));
    state_.least_round_trip_s = *std::min_element(trips_s_.begin(), end);
  }
  last_ = report;
  last_at_ = now;
  return true;
}

LinkSample LinkObserver::take_sample() {
  return std::exchange(sample_, {});
}

LinkState LinkObserver::state(Microseconds now) const {
  LinkState state = state_;
  state.time_s = static_cast<double>(now) * 1e-6;
  state.report_age_s = last_ ? static_cast<double>(now - last_at_) * 1e-6 : 0.0;
  return state;
}

}  // namespace sweepcast::link
