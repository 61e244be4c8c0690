// What the link carries while there is something to send.
#pragma once

#include <cmath>
#include <cstddef>

namespace sweepcast {

/// Of `budget`, and of whoever paces what it sends: busy seconds in which the estimate forgets, and
/// bytes a second before anything is known.
inline constexpr double kRateMemory = 0.25;
inline constexpr double kFirstRate = 100e3;

/// A mean of the rate in which the latest counts most: its memory fades over the time that the link
/// was busy, so that an idle link forgets nothing.
class RateEstimate {
 public:
  /// `memory_s`: after so many busy seconds what was before counts 1/e. `first`: bytes a second
  /// until anything is measured.
  RateEstimate(double memory_s, double first) : memory_s_(memory_s), bytes_per_s_(first) {}

  void add(std::size_t sent_bytes, double busy_s) {
    if (busy_s <= 0.0) return;
    const double keep = std::exp(-busy_s / memory_s_);
    const double rate = static_cast<double>(sent_bytes) / busy_s;
    bytes_per_s_ = keep * bytes_per_s_ + (1.0 - keep) * rate;
  }

  [[nodiscard]] double bytes_per_s() const { return bytes_per_s_; }

 private:
  double memory_s_;
  double bytes_per_s_;
};

}  // namespace sweepcast
