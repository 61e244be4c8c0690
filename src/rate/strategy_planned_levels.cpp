// Ours for codecs that have a ladder alone: whole frames in order, levels planned ahead.
#include <algorithm>
#include <cmath>
#include <optional>

#include "rate/ladder_plan.hpp"
#include "rate/rate_estimate.hpp"
#include "rate/strategy.hpp"

namespace sweepcast {
namespace {

/// Seconds in which the estimate of the rate forgets.
constexpr double kMemory = 0.5;
/// Before anything is known, and at least, bytes a second.
constexpr double kFirstLevelRate = 300e3;
constexpr double kSlowestRate = 1e3;
/// A plan is good for rates that differ from its own by no more than this share.
constexpr double kSameRate = 0.02;

class PlannedLevels final : public Strategy {
 public:
  Choice decide(const LinkView& view) override {
    rate_.add(view.sent_bytes, view.busy_s);
    const double rate = std::max(kSlowestRate, rate_.bytes_per_s());
    if (!plan_ || std::abs(rate - planned_rate_) > kSameRate * planned_rate_) {
      plan_.emplace(view.level_bytes, rate * view.period_s);
      planned_rate_ = rate;
    }
    level_ = plan_->choose(static_cast<double>(view.queued_bytes), level_);
    return {.level = level_};
  }

 private:
  RateEstimate rate_{kMemory, kFirstLevelRate};
  std::optional<LadderPlan> plan_;
  double planned_rate_ = 0.0;  ///< that `plan_` is for
  std::size_t level_ = 0;
};

}  // namespace

std::unique_ptr<Strategy> make_planned_levels() {
  return std::make_unique<PlannedLevels>();
}

}  // namespace sweepcast
