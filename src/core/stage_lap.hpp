// The trace points of `StageClock`.
#pragma once

#include <string_view>

#include "sweepcast/stages.hpp"

namespace sweepcast {

/// Laps of a clock: each ends a stage and begins the next. Without a clock a lap is one comparison.
class StageLap {
 public:
  explicit StageLap(StageClock* clock) : clock_(clock) {
    if (clock_ != nullptr) began_ = std::chrono::steady_clock::now();
  }

  /// Counts the time since the lap before as this stage's.
  void end(std::string_view stage) {
    if (clock_ == nullptr) return;
    const auto now = std::chrono::steady_clock::now();
    clock_->add(stage, now - began_);
    began_ = now;
  }

 private:
  StageClock* clock_;
  std::chrono::steady_clock::time_point began_;
};

}  // namespace sweepcast
