// Asks a bitrate strategy on behalf of a live sender: what it has to know, from what reports tell.
#pragma once

#include <array>
#include <cstddef>
#include <memory>

#include "link/feedback.hpp"
#include "rate/rate_estimate.hpp"
#include "rate/strategy.hpp"

namespace sweepcast::link {

/// No clock and no socket: the sender tells the time.
class RateControl {
 public:
  /// Without a report for so long, while packets are under way, the link counts as busy with
  /// nothing; seconds.
  static constexpr double kSilence = 0.2;

  /// `period_s`: from sweep to sweep.
  RateControl(std::unique_ptr<Strategy> strategy, CodecId codec, double period_s);

  /// A connection began: what was measured before counts on, but nothing is overdue.
  void begin(Microseconds now);

  /// What the link carried, by the receiver's reports.
  void add(LinkSample sample);

  /// How things are when a sweep is to be encoded.
  struct Situation {
    std::size_t queued_frames = 0, queued_bytes = 0;  ///< not yet sent
    std::size_t bytes_under_way = 0;                  ///< sent, and not known to have arrived
    bool connected = false;
    std::size_t sensors = 1;
  };
  /// Asks the strategy; to be called once a period.
  [[nodiscard]] Choice decide(const LinkState& link, const Situation& situation);

  /// Learns what a frame takes at a level of the ladder.
  void learn(std::size_t level, std::size_t bytes);

  /// The pace at which packets are to leave, bytes a second: somewhat more than the link is thought
  /// to carry, so that it shows what it does carry.
  [[nodiscard]] double pace() const;
  /// What the link is thought to carry, bytes a second.
  [[nodiscard]] double rate() const { return rate_.bytes_per_s(); }
  [[nodiscard]] SendOrder order() const { return strategy_->order(); }

 private:
  void count(LinkSample sample);
  [[nodiscard]] std::size_t bytes_ahead(const LinkState& link, const Situation& situation) const;

  std::unique_ptr<Strategy> strategy_;
  double period_s_;
  RateEstimate rate_;
  LinkSample sample_;  ///< since the strategy was last asked
  double asked_s_ = 0.0;
  double overdue_s_ = 0.0;  ///< silence that was counted as busy before reports tell of it
  bool has_begun_ = false;
  std::array<std::size_t, kLevels> level_bytes_;
  std::array<bool, kLevels> is_learned_{};
};

}  // namespace sweepcast::link
