#include "rate/ladder_plan.hpp"

#include <algorithm>
#include <cmath>

namespace sweepcast {

LadderPlan::LadderPlan(std::span<const std::size_t> level_bytes, double sweep_bytes)
    : sweep_bytes_(sweep_bytes), value_(kQueues * level_bytes.size(), 0.0) {
  for (const std::size_t bytes : level_bytes) {
    frame_.push_back(static_cast<double>(bytes) / sweep_bytes);
  }
  const std::size_t levels = frame_.size();
  std::vector<double> next(value_.size());
  for (std::size_t sweep = 1; sweep < kSweeps; ++sweep) {
    for (std::size_t queue = 0; queue < kQueues; ++queue) {
      for (std::size_t last = 0; last < levels; ++last) {
        const double length = static_cast<double>(queue) / kSteps;
        double best = worth(length, last, 0);
        for (std::size_t level = 1; level < levels; ++level) {
          best = std::max(best, worth(length, last, level));
        }
        next[queue * levels + last] = best;
      }
    }
    value_.swap(next);
  }
}

std::size_t LadderPlan::choose(double queued_bytes, std::size_t last) const {
  const double queue = queued_bytes / sweep_bytes_;
  std::size_t best = frame_.size() - 1;
  for (std::size_t level = frame_.size() - 1; level-- > 0;) {
    if (worth(queue, last, level) > worth(queue, last, best)) best = level;
  }
  return best;
}

/// Of sending the next sweep at this level, and of all that come after.
double LadderPlan::worth(double queue, std::size_t last, std::size_t level) const {
  const double quality = level_quality(level);
  const double end = queue + frame_[level];
  // Its share in all the K that follow: the sweeps that find it not fully sent.
  const double waits = std::floor(end);
  return quality - kQueueWeight * waits - std::abs(quality - level_quality(last)) +
         later(std::max(0.0, end - 1.0), level);
}

/// Between the queues that are tabulated, linear; beyond the longest, as there, and dearer.
double LadderPlan::later(double queue, std::size_t level) const {
  const std::size_t levels = frame_.size();
  const double place = std::min(queue * kSteps, static_cast<double>(kQueues - 1));
  const auto below = std::min(static_cast<std::size_t>(place), kQueues - 2);
  const double share = place - static_cast<double>(below);
  const double value =
      (1.0 - share) * value_[below * levels + level] + share * value_[(below + 1) * levels + level];
  return value - kQueueWeight * kSweeps * std::max(0.0, queue - kLongest);
}

}  // namespace sweepcast
