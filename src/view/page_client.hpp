// A client that shows the page: protocol sweepcast.view.v1.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>

#include "view/client.hpp"
#include "view/player.hpp"
#include "view/recording.hpp"

namespace sweepcast::view {

class PageClient : public Client {
 public:
  static constexpr std::uint32_t kMostCredit = 64;  ///< sweeps that may be granted ahead

  /// Asks a robot for a level, or for its own choice; false where that robot does not obey.
  using AskLevel = std::function<bool(const std::string& robot, std::optional<std::size_t> level)>;

  /// `show` and `recording` outlive it; `recording` is null where sweeps are live. Without
  /// `ask_level` no robot obeys.
  PageClient(const Show& show, Recording* recording, Clock::time_point now,
             AskLevel ask_level = {});

  [[nodiscard]] Status take(std::string_view message, bool is_text, Clock::time_point now) override;
  [[nodiscard]] std::optional<Message> next(Clock::time_point now) override;
  [[nodiscard]] std::optional<Clock::time_point> due(Clock::time_point now) override;
  void offer(const SharedSweep& sweep) override { waiting_.add(sweep); }
  void streams_changed() override { hello_due_ = true; }
  void tell_status(const std::string& status) override { status_ = status; }
  void notify(NoticeLevel level, const std::string& text) override;

 private:
  void ask_level(const Command& command);
  [[nodiscard]] Status play(const Command& command, Clock::time_point now);
  [[nodiscard]] std::optional<Message> next_text(Clock::time_point now);
  [[nodiscard]] SharedSweep next_sweep(Clock::time_point now);
  [[nodiscard]] SharedSweep next_of_recording(Clock::time_point now);

  const Show& show_;
  Recording* recording_;
  AskLevel ask_level_;
  std::optional<Player> player_;
  std::optional<std::uint32_t> shown_;  ///< the frame that was sent last
  std::uint32_t credit_ = 0;
  WaitingSweeps waiting_;
  bool hello_due_ = true;
  bool state_due_;
  std::string status_;               ///< waits; empty where none does
  std::deque<std::string> notices_;  ///< wait
};

}  // namespace sweepcast::view
