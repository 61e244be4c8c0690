// The built-in choice of a budget: the link's capacity from what arrives while it is full.
#include <algorithm>

#include "sweepcast/link.hpp"

namespace sweepcast {
namespace {

constexpr double kFirstCapacity = 100e3;  // bytes a second
constexpr double kLeastCapacity = 8e3;
constexpr double kMostCapacity = 100e6;
constexpr double kFullDelay_s = 0.04;  // a queue this long: the link is full
constexpr double kFreeDelay_s = 0.02;  // and this short: it is not
constexpr double kBackOff = 0.9;       // of what arrived, so that the queue drains
constexpr double kHold_s = 0.3;        // between two steps down: their effect takes time
constexpr double kGrowth = 0.4;        // a second, while the link is used and not full
constexpr double kUsed = 0.5;          // share of the capacity from which it counts as used
constexpr double kSilence_s = 0.3;     // without a report: an outage
constexpr double kPace = 1.25;         // packets of a sweep leave faster than on average
constexpr double kShare = 0.85;        // of the capacity for sweeps; the rest is repetition
constexpr double kOverhead = 1.07;     // heads and tags of packets

class MeasuredCapacity {
 public:
  explicit MeasuredCapacity(double interval_s) : interval_s_(interval_s) {}

  LinkBudget operator()(const LinkState& link) {
    const double elapsed = std::clamp(link.time_s - last_s_, 0.0, 0.2);
    last_s_ = link.time_s;
    // A sweep's packets come in a burst: over a report's 50 ms rates are peaks, so they are
    // smoothed.
    const double weight = elapsed / (elapsed + interval_s_);
    rate_ += weight * (link.receive_rate - rate_);
    const bool silent = link.report_age_s > kSilence_s;
    if (silent || link.queue_delay_s > kFullDelay_s) {
      if (link.time_s >= hold_until_s_) {
        const double arrived = silent ? 0.5 * capacity_ : std::max(rate_, 0.5 * capacity_);
        capacity_ = std::min(capacity_, kBackOff * arrived);
        hold_until_s_ = link.time_s + kHold_s;
      }
    } else if (link.queue_delay_s < kFreeDelay_s && rate_ > kUsed * capacity_) {
      capacity_ *= 1.0 + kGrowth * elapsed;
    }
    capacity_ = std::clamp(capacity_, kLeastCapacity, kMostCapacity);
    const double sweep = kShare / kOverhead * capacity_ * interval_s_;
    return {kPace * capacity_, static_cast<std::size_t>(sweep)};
  }

 private:
  double interval_s_;
  double capacity_ = kFirstCapacity;
  double rate_ = 0;
  double last_s_ = 0;
  double hold_until_s_ = 0;
};

}  // namespace

BudgetChoice measured_capacity_budget(double interval_s) {
  return MeasuredCapacity(std::clamp(interval_s, 0.01, 10.0));
}

}  // namespace sweepcast
