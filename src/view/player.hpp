// A recording's clock: which of its frames is up, for one client.
#pragma once

#include <cstdint>
#include <optional>

#include "view/sweep.hpp"

namespace sweepcast::view {

class Player {
 public:
  static constexpr double kLeastSpeed = 0.01;
  static constexpr double kMostSpeed = 100.0;

  /// Starts to play, over and over. `frames` and `rate_hz` are above 0.
  Player(std::uint32_t frames, double rate_hz, Clock::time_point now);

  /// Goes on; from the beginning where the end was reached.
  void play(Clock::time_point now);
  void pause(Clock::time_point now);
  /// A number beyond the last frame's means the last one.
  void seek(std::uint32_t index, Clock::time_point now);
  /// Limited to the bounds above.
  void set_speed(double speed, Clock::time_point now);
  void set_loop(bool loop, Clock::time_point now);

  /// The frame that is up. Where the end is reached and nothing is repeated, playing stops.
  [[nodiscard]] std::uint32_t index(Clock::time_point now);
  /// When another one will be; none while paused.
  [[nodiscard]] std::optional<Clock::time_point> next_change(Clock::time_point now);

  [[nodiscard]] bool playing() const { return playing_; }
  [[nodiscard]] double speed() const { return speed_; }
  [[nodiscard]] bool loop() const { return loop_; }

 private:
  void settle(Clock::time_point now);

  std::uint32_t frames_;
  double rate_hz_;
  double speed_ = 1.0;
  bool playing_ = true;
  bool loop_ = true;
  double at_ = 0.0;  ///< frames, at the time `since_`
  Clock::time_point since_;
};

}  // namespace sweepcast::view
