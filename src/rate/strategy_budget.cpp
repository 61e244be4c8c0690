// Ours: what the link will surely take until the next sweep, the freshest sweep first.
#include <algorithm>

#include "rate/rate_estimate.hpp"
#include "rate/strategy.hpp"

namespace sweepcast {
namespace {

/// Share of the estimated capacity that a sweep may take; the rest makes up for swings.
constexpr double kShare = 0.6;
/// Time over which the rate is averaged, of those in which the link was busy, seconds.
constexpr double kMemory = 0.4;
/// The most that a budget grows from sweep to sweep.
constexpr double kGrowth = 1.2;
/// Bounds of a budget, bytes: below, frames are mostly overhead; above, nothing is gained.
constexpr double kLeast = 2300.0;
constexpr double kMost = 45000.0;
/// Before anything is known, bytes a second.
constexpr double kFirstRate = 100e3;

class Budget final : public Strategy {
 public:
  Choice decide(const LinkView& view) override {
    rate_.add(view.sent_bytes, view.busy_s);
    const double wanted = kShare * rate_.bytes_per_s() * view.period_s;
    budget_ = std::clamp(std::min(wanted, kGrowth * budget_), kLeast, kMost);
    return {.bytes = static_cast<std::size_t>(budget_)};
  }

  SendOrder order() const override { return SendOrder::freshest_first; }

 private:
  RateEstimate rate_{kMemory, kFirstRate};
  double budget_ = kLeast;
};

}  // namespace

std::unique_ptr<Strategy> make_budget() {
  return std::make_unique<Budget>();
}

}  // namespace sweepcast
