#include "lab/stream/session.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "rate/send_queue.hpp"

namespace sweepcast::lab {
namespace {

/// How long the sender goes on after the last sweep.
constexpr std::int64_t kDrainUs = 60'000'000;
/// What is overtaken waits for spare time, so many layers of it, so long.
constexpr std::size_t kLateLayers = 3;
constexpr std::int64_t kLateUs = 60'000'000;

/// Bytes of a frame that travel together.
struct Piece {
  std::uint64_t frame = 0;
  std::size_t begin = 0;  ///< from the frame's start
  std::size_t bytes = 0;
};

/// The setting that a choice means: a level, or the largest budget, or else level, that fits.
std::size_t setting_of(const FrameSet& frames, std::span<const std::size_t> level_bytes,
                       const Choice& choice) {
  if (choice.level) return std::min(*choice.level, frames.ladder - 1);
  const bool has_budgets = frames.settings() > frames.ladder;
  const std::size_t begin = has_budgets ? frames.ladder : 0;
  const std::size_t end = has_budgets ? frames.settings() : frames.ladder;
  for (std::size_t i = begin; i < end; ++i) {
    if ((has_budgets ? frames.target_bytes[i] : level_bytes[i]) <= choice.bytes) return i;
  }
  return end - 1;
}

/// A sender and a receiver with a link between them.
class Session {
 public:
  Session(const FrameSet& frames, const Trace& trace, const SessionOptions& options,
          Strategy& strategy)
      : frames_(frames),
        options_(options),
        strategy_(strategy),
        level_bytes_(frames.level_bytes()),
        link_(trace, without_queue(options.link)),
        queue_(strategy.order(), kLateLayers) {}

  std::vector<SweepFate> run() {
    const double period_us = 1e6 / options_.rate_hz;
    for (std::size_t i = 0; i < options_.sweeps; ++i) {
      const auto ready_us = std::llround(static_cast<double>(i + 1) * period_us);
      send_until(ready_us);
      encode(i, ready_us);
    }
    send_until(now_us_ + kDrainUs);
    for (std::size_t i = 0; i < options_.sweeps; ++i) settle(i);
    return std::move(fates_);
  }

 private:
  /// Packets of a frame: where each begins, where it ends and when it arrived.
  struct Arrival {
    std::size_t end = 0;
    std::int64_t at_us = 0;
  };

  static LinkOptions without_queue(LinkOptions options) {
    options.queue_limit = 0;  // that of the sender stands for it
    return options;
  }

  void encode(std::size_t index, std::int64_t now_us) {
    SweepFate fate;
    fate.ready_us = now_us;
    fate.queued_frames = queued_frames();
    fate.queued_bytes = queued_bytes();
    LinkView view;
    view.period_s = 1.0 / options_.rate_hz;
    view.delay_s = static_cast<double>(options_.link.delay_us + options_.link.jitter_us) * 1e-6;
    view.queued_frames = fate.queued_frames;
    view.queued_bytes = fate.queued_bytes;
    view.sent_bytes = std::exchange(sent_bytes_, 0);
    view.busy_s = static_cast<double>(std::exchange(busy_us_, 0)) * 1e-6;
    view.level_bytes = level_bytes_;
    const std::size_t sweep = index % frames_.sweeps();
    const Choice choice = strategy_.decide(view);
    fate.sent = {sweep, setting_of(frames_, level_bytes_, choice), 0};
    const FrameSize& size = frames_.sizes[sweep][fate.sent.setting];
    std::vector<std::size_t> ends = size.layer_ends;
    if (index % static_cast<std::size_t>(options_.model_interval) == 0) {
      for (std::size_t& end : ends) end += size.model;
    }
    layer_ends_.push_back(ends);
    arrivals_.emplace_back();
    const auto limit = static_cast<std::size_t>(options_.link.queue_limit);
    fate.skipped = choice.skip || (limit > 0 && fate.queued_bytes + ends.back() > limit);
    if (!fate.skipped) {
      const bool is_late_over = strategy_.order() == SendOrder::freshest_first;
      const std::int64_t deadline_us =
          is_late_over ? now_us + kLateUs + 1 : std::numeric_limits<std::int64_t>::max();
      queue_.push({index, 0, std::move(ends), deadline_us}, now_us);
    }
    fates_.push_back(fate);
  }

  /// Hands packets to the link, each when the one before has left, up to an instant.
  void send_until(std::int64_t end_us) {
    if (link_free_us_ > now_us_) busy_us_ += std::min(link_free_us_, end_us) - now_us_;
    leave_link(end_us);
    while (true) {
      now_us_ = std::max(now_us_, link_free_us_);
      if (now_us_ >= end_us) break;
      const auto piece = next_piece();
      if (!piece && lost_.empty()) break;
      if (!piece) {
        now_us_ = lost_.begin()->first;
        continue;
      }
      hand_over(*piece);
      busy_us_ += std::min(link_free_us_, end_us) - now_us_;
      leave_link(end_us);
    }
    now_us_ = end_us;
  }

  /// What is lost goes first, once it is known to be.
  std::optional<Piece> next_piece() {
    if (lost_.empty() || lost_.begin()->first > now_us_) {
      const auto next = queue_.next(now_us_);
      if (!next) return std::nullopt;
      const std::size_t bytes = std::min(kPacketBytes, next->end - next->begin);
      queue_.take(bytes);
      return Piece{next->frame, next->begin, bytes};
    }
    const Piece piece = lost_.begin()->second;
    lost_.erase(lost_.begin());
    return piece;
  }

  void hand_over(const Piece& piece) {
    const PacketFate fate = *link_.send(now_us_, static_cast<std::int64_t>(piece.bytes));
    link_free_us_ = fate.sent_us;
    on_link_ = piece;
    fates_[piece.frame].bytes += piece.bytes;
    if (fate.arrives_us) {
      arrivals_[piece.frame][piece.begin] = {piece.begin + piece.bytes, *fate.arrives_us};
    } else {
      lost_.emplace(fate.sent_us + 2 * options_.link.delay_us + options_.link.jitter_us, piece);
    }
  }

  /// Counts the packet on the link as sent, where it has left before an instant.
  void leave_link(std::int64_t end_us) {
    if (!on_link_ || link_free_us_ >= end_us) return;
    sent_bytes_ += on_link_->bytes;
    on_link_.reset();
  }

  std::size_t queued_frames() const {
    return queue_.frames() + (on_link_ && !queue_.contains(on_link_->frame) ? 1 : 0);
  }

  std::size_t queued_bytes() const { return queue_.bytes() + (on_link_ ? on_link_->bytes : 0); }

  /// What arrived of a frame, once all is sent.
  void settle(std::size_t index) {
    SweepFate& fate = fates_[index];
    std::size_t covered = 0;
    std::int64_t at_us = 0;
    const auto& ends = layer_ends_[index];
    for (const auto& [begin, arrival] : arrivals_[index]) {
      if (begin > covered) break;
      covered = arrival.end;
      at_us = std::max(at_us, arrival.at_us);
      while (fate.sent.layers < ends.size() && ends[fate.sent.layers] <= covered) {
        ++fate.sent.layers;
        fate.decoded_us = at_us;
      }
    }
  }

  const FrameSet& frames_;
  SessionOptions options_;
  Strategy& strategy_;
  std::vector<std::size_t> level_bytes_;
  LinkModel link_;
  SendQueue queue_;
  std::multimap<std::int64_t, Piece> lost_;  ///< by when they may be sent again
  std::optional<Piece> on_link_;             ///< handed over and not yet sent
  std::int64_t now_us_ = 0;
  std::int64_t link_free_us_ = 0;  ///< when the last packet that was handed over has left
  std::size_t sent_bytes_ = 0;     ///< since the sweep before
  std::int64_t busy_us_ = 0;       ///< the same
  std::vector<SweepFate> fates_;
  std::vector<std::vector<std::size_t>> layer_ends_;      ///< [sweep]
  std::vector<std::map<std::size_t, Arrival>> arrivals_;  ///< [sweep], by the byte they begin with
};

}  // namespace

std::vector<SweepFate> run_session(const FrameSet& frames, const Trace& trace,
                                   const SessionOptions& options, Strategy& strategy) {
  return Session(frames, trace, options, strategy).run();
}

}  // namespace sweepcast::lab
