#include "link/rate_control.hpp"

#include <algorithm>
#include <utility>

namespace sweepcast::link {
namespace {

constexpr double kPace = 1.5;
/// SRT acknowledges every 10 ms; seconds.
constexpr double kAcknowledged = 0.02;
/// Packets are then near enough to each other for a train, see `ArrivalMeter`.
constexpr double kLeastPace = 120e3;
constexpr double kMostPace = 100e6;
/// Of what is learned about a level, the newest frame's share.
constexpr double kNews = 0.1;

/// Frames of a 64-beam sensor, finest level first: a guess until frames were sent.
constexpr std::array<std::size_t, kLevels> kBeamBytes{60'000, 38'000, 22'000, 12'000, 7'500, 5'000};
constexpr std::array<std::size_t, kLevels> kRcpccBytes{21'000, 17'000, 15'000, 7'400, 6'600, 2'250};

}  // namespace

RateControl::RateControl(std::unique_ptr<Strategy> strategy, CodecId codec, double period_s)
    : strategy_(std::move(strategy)),
      period_s_(period_s),
      rate_(kRateMemory, kFirstRate),
      level_bytes_(codec == CodecId::beam ? kBeamBytes : kRcpccBytes) {}

void RateControl::begin(Microseconds now) {
  has_begun_ = true;
  overdue_s_ = 0.0;
  asked_s_ = static_cast<double>(now) * 1e-6;
}

void RateControl::add(LinkSample sample) {
  const double known = std::min(sample.busy_s, overdue_s_);
  overdue_s_ -= known;
  sample.busy_s -= known;
  count(sample);
}

void RateControl::count(LinkSample sample) {
  sample_.bytes += sample.bytes;
  sample_.busy_s += sample.busy_s;
  rate_.add(sample.bytes, sample.busy_s);
}

Choice RateControl::decide(const LinkState& link, const Situation& situation) {
  const double elapsed = std::clamp(link.time_s - asked_s_, 0.0, 1.0);
  asked_s_ = link.time_s;
  const bool is_silent =
      situation.connected && link.report_age_s > kSilence && situation.bytes_under_way > 0;
  const bool is_cut_off = has_begun_ && !situation.connected;
  if (is_silent || is_cut_off) {
    count({0, elapsed});
    overdue_s_ += elapsed;
  }
  LinkView view;
  view.period_s = period_s_;
  view.delay_s = link.least_round_trip_s / 2.0;
  view.queued_frames = situation.queued_frames;
  view.queued_bytes = situation.queued_bytes + situation.bytes_under_way;
  view.ahead_bytes = bytes_ahead(link, situation);
  view.sent_bytes = sample_.bytes;
  view.busy_s = sample_.busy_s;
  sample_ = {};
  std::array<std::size_t, kLevels> level_bytes = level_bytes_;
  for (std::size_t& bytes : level_bytes) bytes *= situation.sensors;
  view.level_bytes = level_bytes;
  return strategy_->decide(view);
}

/// Of what is under way, that which the link does not hold while it keeps up.
std::size_t RateControl::bytes_ahead(const LinkState& link, const Situation& situation) const {
  const double held = rate_.bytes_per_s() * (link.least_round_trip_s + kAcknowledged);
  const double more = static_cast<double>(situation.bytes_under_way) - held;
  return static_cast<std::size_t>(std::max(0.0, more));
}

void RateControl::learn(std::size_t level, std::size_t bytes) {
  if (level >= kLevels || bytes == 0) return;
  const double old = static_cast<double>(level_bytes_[level]);
  const double share = is_learned_[level] ? kNews : 1.0;
  const double size = old + share * (static_cast<double>(bytes) - old);
  level_bytes_[level] = static_cast<std::size_t>(size);
  is_learned_[level] = true;
  for (std::size_t other = 0; other < kLevels; ++other) {  // the others keep their ratio to it
    if (is_learned_[other]) continue;
    level_bytes_[other] = std::max<std::size_t>(
        1, static_cast<std::size_t>(static_cast<double>(level_bytes_[other]) * size / old));
  }
}

double RateControl::pace() const {
  return std::clamp(kPace * rate_.bytes_per_s(), kLeastPace, kMostPace);
}

}  // namespace sweepcast::link
