// Deskewed sweeps: the twist that a sweep was moved by, undone and done again.
#pragma once

#include <array>

#include "sweepcast/sensor_model.hpp"

namespace sweepcast {

/// The twist of a motion in doubles. From + - * / alone, so that encoder and decoder agree.
class Twist {
 public:
  explicit Twist(const Motion& motion);

  /// p = R(s * rotation) q + s * translation: from the deskewed point to the sensor's own.
  [[nodiscard]] std::array<double, 3> undo(const std::array<double, 3>& q, double s) const;

  /// The inverse: q = R(s * rotation)^T (p - s * translation).
  [[nodiscard]] std::array<double, 3> redo(const std::array<double, 3>& p, double s) const;

 private:
  [[nodiscard]] std::array<double, 3> turn(const std::array<double, 3>& p, double s) const;

  std::array<double, 3> translation_m_{}, rotation_{};  // rotation in radians
  double angle_squared_ = 0.0;
};

/// Time of a whole tick within the sweep: turns from the motion's zero, [-1/2, 1/2).
[[nodiscard]] inline double motion_time(int tick, const Motion& motion, int ticks_per_turn) {
  int from_zero = (tick - motion.zero_tick) % ticks_per_turn;
  if (from_zero < 0) from_zero += ticks_per_turn;
  if (2 * from_zero >= ticks_per_turn) from_zero -= ticks_per_turn;
  return static_cast<double>(from_zero) / ticks_per_turn;
}

}  // namespace sweepcast
