// Ours for codec beam: what the link will surely take until the next sweep, the freshest first.
#include <algorithm>

#include "rate/rate_estimate.hpp"
#include "rate/strategy.hpp"

namespace sweepcast {
namespace {

/// Share of the estimated capacity that a sweep may take; the rest makes up for swings, and sends
/// what was overtaken.
constexpr double kShare = 0.8;
/// Sweeps are wanted so long after their last firing, seconds; by then a sweep must have been sent
/// and have passed the link, and swings may take the last third of what is left for sending.
constexpr double kDeadline = 0.15;
constexpr double kSendingShare = 2.0 / 3.0;
/// The most that a budget grows by from sweep to sweep: quality rises smoothly, and from the
/// least to the most in a second and a half. It falls at once.
constexpr double kGrowth = 1.2;
/// Bounds of a budget, bytes. Half the bytes at the lower one lose half of F@10cm; more than the
/// upper one gains nothing.
constexpr double kLeast = 3600.0;
constexpr double kMost = 45'000.0;

class Budget final : public Strategy {
 public:
  Choice decide(const LinkView& view) override {
    rate_.add(view.sent_bytes, view.busy_s);
    const double sending_s =
        std::min(view.period_s, kSendingShare * std::max(0.0, kDeadline - view.delay_s));
    const double wanted =
        kShare * rate_.bytes_per_s() * sending_s - static_cast<double>(view.ahead_bytes);
    budget_ = std::clamp(std::min(wanted, kGrowth * budget_), kLeast, kMost);
    return {.bytes = static_cast<std::size_t>(budget_)};
  }

  SendOrder order() const override { return SendOrder::freshest_first; }

 private:
  RateEstimate rate_{kRateMemory, kFirstRate};
  double budget_ = kLeast;
};

}  // namespace

std::unique_ptr<Strategy> make_budget() {
  return std::make_unique<Budget>();
}

}  // namespace sweepcast
