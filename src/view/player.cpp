#include "view/player.hpp"

#include <algorithm>
#include <cmath>

namespace sweepcast::view {

Player::Player(std::uint32_t frames, double rate_hz, Clock::time_point now)
    : frames_(frames), rate_hz_(rate_hz), since_(now) {}

/// Brings `at_` up to now.
void Player::settle(Clock::time_point now) {
  const double passed_s = std::chrono::duration<double>(now - since_).count();
  since_ = now;
  if (!playing_) return;
  at_ += std::max(passed_s, 0.0) * rate_hz_ * speed_;
  const double end = frames_;
  if (at_ < end) return;
  if (loop_) {
    at_ = std::fmod(at_, end);
  } else {
    at_ = end - 1.0;
    playing_ = false;
  }
}

void Player::play(Clock::time_point now) {
  settle(now);
  if (!playing_ && !loop_ && at_ >= frames_ - 1.0) at_ = 0.0;
  playing_ = true;
}

void Player::pause(Clock::time_point now) {
  settle(now);
  playing_ = false;
}

void Player::seek(std::uint32_t index, Clock::time_point now) {
  settle(now);
  at_ = std::min(index, frames_ - 1);
}

void Player::set_speed(double speed, Clock::time_point now) {
  settle(now);
  speed_ = std::clamp(speed, kLeastSpeed, kMostSpeed);
}

void Player::set_loop(bool loop, Clock::time_point now) {
  settle(now);
  loop_ = loop;
}

std::uint32_t Player::index(Clock::time_point now) {
  settle(now);
  return std::min(static_cast<std::uint32_t>(at_), frames_ - 1);
}

std::optional<Clock::time_point> Player::next_change(Clock::time_point now) {
  settle(now);
  if (!playing_) return std::nullopt;
  const double frames = std::floor(at_) + 1.0 - at_;
  const std::chrono::duration<double> wait(frames / (rate_hz_ * speed_));
  // A little later, so that rounding does not leave us just before it.
  return now + std::chrono::duration_cast<Clock::duration>(wait) + std::chrono::microseconds(1);
}

}  // namespace sweepcast::view
