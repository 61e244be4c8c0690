// Where an encoder or a decoder spends its time.
#pragma once

#include <chrono>
#include <cstddef>
#include <string_view>
#include <vector>

namespace sweepcast {

/// What one stage has taken so far.
struct StageTime {
  std::string_view stage;  ///< as in "SA-DCT"; lives as long as the program
  std::chrono::nanoseconds time{0};
};

/// Adds up what the stages of an encoder or a decoder take, by the monotonic clock. Hand one over
/// in `EncoderOptions::stages` or `DecoderOptions::stages`; it must outlive whom it was handed to,
/// and belongs to one thread with it. Without one, nothing is measured.
class StageClock {
 public:
  /// `stage` must live as long as the program does.
  void add(std::string_view stage, std::chrono::nanoseconds time) {
    for (StageTime& known : stages_) {
      if (known.stage != stage) continue;
      known.time += time;
      return;
    }
    stages_.push_back({stage, time});
  }

  /// In the order in which they first came. Stages follow each other: their sum is the whole.
  [[nodiscard]] const std::vector<StageTime>& stages() const { return stages_; }

  void clear() { stages_.clear(); }

 private:
  std::vector<StageTime> stages_;
};

}  // namespace sweepcast
