// RobustMPC: X. Yin, A. Jindal, V. Sekar, B. Sinopoli, "A control-theoretic approach for dynamic
// adaptive video streaming over HTTP", SIGCOMM 2015; with equation 5 as what is made large.
#include <algorithm>
#include <cmath>

#include "rate/recent.hpp"
#include "rate/strategy.hpp"

namespace sweepcast {
namespace {

/// Steps that are planned ahead, and rates that the prediction looks back on: the MPC paper's.
constexpr int kHorizon = 5;
constexpr std::size_t kRates = 5;
/// Sweeps that a step takes: a second, as a chunk of video takes seconds.
constexpr double kStepSweeps = 10.0;
/// A rate is measured where the link was busy for at least so long, seconds.
constexpr double kLeastBusy = 0.005;
/// Until a rate is measured, and where nothing at all went through, bytes a second.
constexpr double kLeastRate = 1000.0;

class Mpc final : public Strategy {
 public:
  Choice decide(const LinkView& view) override {
    measure(view);
    view_ = &view;
    sweep_bytes_ = predict() * view.period_s;
    const auto backlog = static_cast<double>(view.queued_bytes);
    const std::size_t choice = best_level(view.level_bytes.size(), [&](std::size_t level) {
      return plan(level, backlog, last_quality_, kHorizon);
    });
    last_quality_ = level_quality(choice);
    return {.level = choice};
  }

 private:
  void measure(const LinkView& view) {
    if (view.busy_s < kLeastBusy) return;
    const double rate = std::max(kLeastRate, static_cast<double>(view.sent_bytes) / view.busy_s);
    if (!rates_.empty()) errors_.add(std::abs(rates_.harmonic_mean() - rate) / rate);
    rates_.add(rate);
  }

  /// The harmonic mean of the last rates, lessened by the largest of the last errors.
  double predict() const {
    return rates_.empty() ? kLeastRate : rates_.harmonic_mean() / (1.0 + errors_.largest());
  }

  /// The most that a step at this level and `depth - 1` more are worth.
  double plan(std::size_t level, double backlog, double last_quality, int depth) const {
    const double quality = level_quality(level);
    const double growth = static_cast<double>(view_->level_bytes[level]) - sweep_bytes_;
    const double end = std::max(0.0, backlog + kStepSweeps * growth);
    // A frame waits for as many sweeps as the link needs for what is before it.
    const double queued = 0.5 * (backlog + end) / sweep_bytes_;
    const double value =
        kStepSweeps * (quality - kQueueWeight * queued) - std::abs(quality - last_quality);
    backlog = end;
    if (depth == 1) return value;
    double best = plan(0, backlog, quality, depth - 1);
    for (std::size_t next = 1; next < view_->level_bytes.size(); ++next) {
      best = std::max(best, plan(next, backlog, quality, depth - 1));
    }
    return value + best;
  }

  Recent rates_{kRates};   ///< bytes a second
  Recent errors_{kRates};  ///< of earlier predictions, relative
  double last_quality_ = level_quality(0);
  const LinkView* view_ = nullptr;  ///< during `decide`
  double sweep_bytes_ = 0.0;        ///< that the link is predicted to take a sweep
};

}  // namespace

std::unique_ptr<Strategy> make_mpc() {
  return std::make_unique<Mpc>();
}

}  // namespace sweepcast
