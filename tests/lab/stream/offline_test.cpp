#include "lab/stream/offline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/random.hpp"
#include "lab/stream/frame_sets.hpp"
#include "lab/stream/summary.hpp"
#include "rounds.hpp"

namespace sweepcast::lab {
namespace {

double mean_qoe(const FrameSet& frames, const Trace& trace, const SessionOptions& options,
                Strategy& strategy) {
  const auto fates = run_session(frames, trace, options, strategy);
  StreamSummary summary;
  summarise(fates, frames, trace, strategy.order(), summary);
  return summary.mean_qoe;
}

/// The largest QoE of all plans, each one run.
double best_by_trying(const FrameSet& frames, const Trace& trace, const SessionOptions& options,
                      Plan& plan) {
  if (plan.size() == options.sweeps) {
    return mean_qoe(frames, trace, options, *make_planned(plan));
  }
  double best = -1e300;
  for (std::size_t level = 0; level <= frames.ladder; ++level) {
    Choice choice{.level = level};
    if (level == frames.ladder) choice = {.skip = true};
    plan.push_back(choice);
    best = std::max(best, best_by_trying(frames, trace, options, plan));
    plan.pop_back();
  }
  return best;
}

Trace random_trace(std::mt19937& random) {
  Trace trace{"random", {}, 0};
  std::int64_t time_us = 0;
  for (int k = 0; k < 40; ++k) {
    time_us +=
        test::uniform_int(random, 0, 10) == 0 ? 200'000 : test::uniform_int(random, 0, 30'000);
    trace.opportunities_us.push_back(time_us);
  }
  trace.period_us = time_us + 1;
  return trace;
}

TEST(Offline, IsTheBestOfAllPlansOnShortTraces) {
  std::mt19937 random(5);
  for (int round = 0; round < 12; ++round) {
    const Trace trace = random_trace(random);
    std::vector<std::size_t> bytes;
    for (std::size_t level = 0; level < kLevels; ++level) {
      bytes.push_back(static_cast<std::size_t>(test::uniform_int(random, 300, 20'000)));
    }
    std::sort(bytes.rbegin(), bytes.rend());
    FrameSet frames = ladder_of(bytes);
    frames.sizes[0][0].model = 500;
    SessionOptions options;
    options.sweeps = 4;
    options.model_interval = 2;
    Plan plan;
    const double best = best_by_trying(frames, trace, options, plan);
    const double planned =
        mean_qoe(frames, trace, options, *make_planned(plan_offline(frames, trace, options)));
    EXPECT_NEAR(planned, best, 1e-9) << "round " << round;
  }
}

TEST(Offline, IsNeverBelowAnyStrategy) {
  std::mt19937 random(6);
  for (int round = 0; round < test::rounds(8); ++round) {
    const Trace trace = round == 0 ? paper_trace() : random_trace(random);
    const FrameSet frames = ladder_of({21'000, 17'000, 15'000, 7'400, 6'600, 2'250});
    SessionOptions options;
    options.sweeps = round == 0 ? 3000 : 300;
    const double limit =
        mean_qoe(frames, trace, options, *make_planned(plan_offline(frames, trace, options)));
    for (const char* name :
         {"paper", "bola", "mpc", "budget", "fixed:0", "fixed:1", "fixed:3", "fixed:5"}) {
      const auto strategy = *make_strategy(name, CodecId::rcpcc);
      EXPECT_LE(mean_qoe(frames, trace, options, *strategy), limit + 1e-9)
          << name << ", round " << round;
    }
    // What goes out of order, too.
    EXPECT_LE(mean_qoe(frames, trace, options, *make_budget()), limit + 1e-9);
    if (round == 0) {
      EXPECT_GE(mean_qoe(frames, trace, options, *make_planned_levels()), 0.95 * limit);
    }
  }
}

TEST(Offline, TakesTheCheapestWayToAQuality) {
  // A budget's frame reaches the finest level's F-score with fewer bytes.
  FrameSet frames = ladder_of({9000, 8000, 7000, 6000, 5000, 4000});
  frames.target_bytes.push_back(3000);
  frames.sizes[0].push_back({{1000, 3000}, 0});
  frames.qualities[{0, 6, 2}] = {90.0, 45.0};
  SessionOptions options;
  options.sweeps = 20;
  const Trace trace = paper_trace();
  for (const Choice& choice : plan_offline(frames, trace, options)) {
    EXPECT_FALSE(choice.level);
    EXPECT_EQ(choice.bytes, 3000U);
  }
}

}  // namespace
}  // namespace sweepcast::lab
