#include "link/link_model.hpp"

#include <algorithm>
#include <string>

namespace sweepcast {
namespace {

constexpr std::int64_t kLongestUs = 60'000'000;

Status check_time(const char* name, std::int64_t time_us) {
  if (time_us >= 0 && time_us <= kLongestUs) return {};
  return fail(ErrorCode::invalid_argument,
              std::string(name) + " of a link must be from 0 to 60 seconds");
}

Status check_chance(const char* name, double chance) {
  if (chance >= 0.0 && chance <= 1.0) return {};
  return fail(ErrorCode::invalid_argument,
              std::string(name) + " of a link is a chance and must be from 0 to 1");
}

}  // namespace

Status check(const LinkOptions& options) {
  if (Status delay = check_time("delay", options.delay_us); !delay) return delay;
  if (Status jitter = check_time("jitter", options.jitter_us); !jitter) return jitter;
  if (Status held = check_time("time held back", options.held_us); !held) return held;
  if (Status loss = check_chance("loss", options.loss); !loss) return loss;
  if (Status held = check_chance("reordering", options.reordering); !held) return held;
  if (options.queue_limit < 0) {
    return fail(ErrorCode::invalid_argument, "queue limit of a link must not be negative");
  }
  return {};
}

LinkPlace TraceLine::at(std::int64_t now_us) const {
  const auto& times = trace_->opportunities_us;
  const auto count = static_cast<std::int64_t>(times.size());
  // A round's times are after its begin and up to its end, so that an end belongs to its own round.
  const std::int64_t round = std::max<std::int64_t>(0, now_us - 1) / trace_->period_us;
  const auto found =
      std::lower_bound(times.begin(), times.end(), now_us - round * trace_->period_us);
  return {round * count + (found - times.begin()), 0};
}

std::int64_t TraceLine::time_us(std::int64_t k) const {
  const auto count = static_cast<std::int64_t>(trace_->opportunities_us.size());
  return k / count * trace_->period_us +
         trace_->opportunities_us[static_cast<std::size_t>(k % count)];
}

LinkPlace TraceLine::after(LinkPlace begin, std::int64_t bytes) {
  const std::int64_t total = begin.bytes + bytes;
  return {begin.opportunity + total / kOpportunityBytes, total % kOpportunityBytes};
}

std::int64_t TraceLine::sent_us(LinkPlace end) const {
  return time_us(end.bytes > 0 ? end.opportunity : std::max<std::int64_t>(end.opportunity - 1, 0));
}

LinkModel::LinkModel(const Trace& trace, const LinkOptions& options)
    : line_(trace), options_(options), random_state_(options.seed) {}

std::optional<PacketFate> LinkModel::send(std::int64_t now_us, std::int64_t bytes) {
  if (options_.queue_limit > 0 && queued_bytes(now_us) + bytes > options_.queue_limit) {
    return std::nullopt;
  }
  end_ = TraceLine::after(std::max(end_, line_.at(now_us)), bytes);
  PacketFate fate{line_.sent_us(end_), std::nullopt};
  // All three are drawn for each packet, so that one option does not change another's chances.
  const bool lost = random() < options_.loss;
  const bool held = random() < options_.reordering;
  const auto jitter_us =
      static_cast<std::int64_t>(random() * static_cast<double>(options_.jitter_us));
  if (lost) return fate;
  const std::int64_t arrival_us =
      std::max(last_arrival_us_, fate.sent_us + options_.delay_us + jitter_us);
  if (held) {
    fate.arrives_us = arrival_us + options_.held_us;
  } else {
    fate.arrives_us = last_arrival_us_ = arrival_us;
  }
  return fate;
}

std::int64_t LinkModel::queued_bytes(std::int64_t now_us) const {
  const LinkPlace now = line_.at(now_us);
  if (end_ <= now) return 0;
  return (end_.opportunity - now.opportunity) * kOpportunityBytes + end_.bytes;
}

double LinkModel::random() {
  // SplitMix64 (Steele, Lea, Flood 2014): the same numbers on every machine.
  std::uint64_t z = random_state_ += 0x9E3779B97F4A7C15ULL;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
}

}  // namespace sweepcast
