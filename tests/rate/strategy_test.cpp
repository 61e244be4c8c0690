#include "rate/strategy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "rate/ladder_plan.hpp"

namespace sweepcast {
namespace {

/// About those of the released levels on a 64-beam sensor.
constexpr std::array<std::size_t, kLevels> kBytes{21'000, 17'000, 15'000, 7'400, 6'600, 2'250};

/// A link of a steady rate that a strategy sends over, a queue of whole frames.
class SteadyLink {
 public:
  explicit SteadyLink(Strategy& strategy) : strategy_(strategy) {}

  /// Sends `sweeps` sweeps at bytes a sweep; returns the levels.
  std::vector<std::size_t> run(int sweeps, double sweep_bytes) {
    std::vector<std::size_t> levels;
    for (int i = 0; i < sweeps; ++i) {
      LinkView view;
      view.level_bytes = kBytes;
      view.queued_frames = queue_.size();
      for (const double bytes : queue_) view.queued_bytes += static_cast<std::size_t>(bytes);
      view.sent_bytes = static_cast<std::size_t>(sent_);
      view.busy_s = busy_;
      longest_ = std::max(longest_, queue_.size());
      const Choice choice = strategy_.decide(view);
      levels.push_back(choice.level.value_or(kLevels));
      queue_.push_back(choice.level ? static_cast<double>(kBytes[*choice.level])
                                    : static_cast<double>(choice.bytes));
      bytes_.push_back(queue_.back());
      send(sweep_bytes);
    }
    return levels;
  }

  std::size_t longest() const { return longest_; }
  const std::vector<double>& bytes() const { return bytes_; }

 private:
  void send(double most) {
    double left = most;
    while (!queue_.empty() && left > 0.0) {
      const double bytes = std::min(left, queue_.front());
      left -= bytes;
      queue_.front() -= bytes;
      if (queue_.front() <= 0.0) queue_.erase(queue_.begin());
    }
    sent_ = most - left;
    busy_ = 0.1 * sent_ / most;
  }

  Strategy& strategy_;
  std::vector<double> queue_;
  std::vector<double> bytes_;  ///< of every frame
  std::size_t longest_ = 0;
  double sent_ = 0.0, busy_ = 0.0;
};

double mean_level(const std::vector<std::size_t>& levels) {
  double sum = 0.0;
  for (const std::size_t level : levels) sum += static_cast<double>(level);
  return sum / static_cast<double>(levels.size());
}

TEST(Strategy, NamesMakeStrategiesAndOthersAreRefused) {
  for (const char* name : {"paper", "bola", "mpc", "budget", "fixed:0", "fixed:5"}) {
    EXPECT_TRUE(make_strategy(name, CodecId::rcpcc)) << name;
  }
  for (const char* name : {"", "Paper", "fixed", "fixed:6", "fixed:-1", "fixed:12", "offline"}) {
    const auto none = make_strategy(name, CodecId::beam);
    ASSERT_FALSE(none) << name;
    EXPECT_EQ(none.error().code, ErrorCode::invalid_argument);
  }
  EXPECT_EQ((*make_strategy("budget", CodecId::beam))->order(), SendOrder::freshest_first);
  EXPECT_EQ((*make_strategy("budget", CodecId::rcpcc))->order(), SendOrder::oldest_first);
}

TEST(Strategy, FixedStays) {
  const auto strategy = make_fixed(3);
  SteadyLink link(*strategy);
  for (const std::size_t level : link.run(20, 1000)) EXPECT_EQ(level, 3U);
}

TEST(Strategy, PaperStepsDownOneByOneWhereTheQueueGrows) {
  const auto strategy = make_paper();
  SteadyLink link(*strategy);
  for (const std::size_t level : link.run(550, 30'000)) EXPECT_EQ(level, 0U);
  const auto levels = link.run(650, 10'000);
  int since = 1000;
  for (std::size_t i = 1; i < levels.size(); ++i, ++since) {
    if (levels[i] == levels[i - 1]) continue;
    EXPECT_EQ(std::max(levels[i], levels[i - 1]) - std::min(levels[i], levels[i - 1]), 1U);
    EXPECT_GE(since, 10) << "switched within the buffer period, at " << i;
    since = 0;
  }
  EXPECT_EQ(*std::max_element(levels.begin(), levels.end()), 5U);
  EXPECT_LT(link.longest(), 30U);
  // More is available: on the whole it sends finer levels than before.
  EXPECT_LT(mean_level(link.run(1250, 13'000)), mean_level(levels) - 0.2);
}

TEST(Strategy, PaperRollsBackAndWaitsLongerBeforeItTriesAgain) {
  const auto strategy = make_paper();
  SteadyLink link(*strategy);
  const auto levels = link.run(3000, 8'000);  // level 3 fits, level 2 is twice too large
  std::vector<std::size_t> attempts;
  for (std::size_t i = 1; i < levels.size(); ++i) {
    if (levels[i] == 2 && levels[i - 1] == 3) attempts.push_back(i);
  }
  ASSERT_GE(attempts.size(), 4U);
  EXPECT_GT(attempts.back() - attempts[attempts.size() - 2], attempts[1] - attempts[0]);
  EXPECT_LT(link.longest(), 40U);
  for (const std::size_t i : attempts) {  // each is undone
    EXPECT_TRUE(
        std::any_of(levels.begin() + static_cast<std::ptrdiff_t>(i),
                    levels.begin() + static_cast<std::ptrdiff_t>(std::min(levels.size(), i + 40)),
                    [](std::size_t level) { return level >= 3; }) ||
        i + 40 > levels.size());
  }
}

TEST(Strategy, BolaIsFinestWithAnEmptyQueueAndCoarsestWithAFullOne) {
  const auto strategy = make_bola();
  LinkView view;
  view.level_bytes = kBytes;
  std::size_t before = 0;
  for (view.queued_frames = 0; view.queued_frames <= 10; ++view.queued_frames) {
    const std::size_t level = *strategy->decide(view).level;
    if (view.queued_frames == 0) {
      EXPECT_EQ(level, 0U);
    }
    EXPECT_GE(level, before);
    before = level;
  }
  EXPECT_EQ(before, 5U);
}

TEST(Strategy, MpcTakesWhatTheLinkCarries) {
  const auto strategy = make_mpc();
  SteadyLink link(*strategy);
  const auto fast = link.run(200, 30'000);
  EXPECT_EQ(fast.back(), 0U);
  const auto slow = link.run(400, 7'500);
  EXPECT_EQ(slow.back(), 3U);
  EXPECT_LT(link.longest(), 10U);
}

TEST(Strategy, PlannedLevelsAreWorthMoreThanTheOneThatAlwaysFits) {
  const auto strategy = make_planned_levels();
  SteadyLink link(*strategy);
  const auto levels = link.run(1000, 13'000);
  EXPECT_LT(mean_level(levels), 2.2);  // level 3 fits always, level 2 never
  EXPECT_LT(link.longest(), 8U);
}

TEST(Strategy, BudgetStaysWithinWhatTheLinkCarriesAndRisesSmoothly) {
  const auto strategy = make_budget();
  SteadyLink link(*strategy);
  static_cast<void>(link.run(300, 20'000));
  EXPECT_NEAR(link.bytes().back(), 16'000, 200);
  for (std::size_t i = 1; i < link.bytes().size(); ++i) {
    EXPECT_LE(link.bytes()[i], 1.2 * link.bytes()[i - 1] + 1.0);
  }
  static_cast<void>(link.run(100, 100));
  EXPECT_EQ(link.bytes().back(), 3600);
  static_cast<void>(link.run(20, 100'000));  // two seconds after an outage it is back
  EXPECT_GT(link.bytes().back(), 40'000);
}

TEST(Strategy, BudgetLeavesTimeForADelay) {
  const auto decide = [](double delay_s) {
    const auto strategy = make_budget();
    LinkView view;
    view.level_bytes = kBytes;
    view.sent_bytes = 20'000;
    view.busy_s = 0.1;
    view.delay_s = delay_s;
    Choice choice;
    for (int i = 0; i < 50; ++i) choice = strategy->decide(view);
    return choice.bytes;
  };
  EXPECT_NEAR(static_cast<double>(decide(0.0)), 16'000, 10);
  EXPECT_NEAR(static_cast<double>(decide(0.06)), 0.6 * 16'000, 10);
  EXPECT_EQ(decide(1.0), 3600U);
}

/// The mean QoE of many sweeps over a link of a steady rate; `level(i, queue)` chooses, the queue
/// in bytes. Frames wait as in `LadderPlan`.
double mean_worth(double sweep_bytes, const std::function<std::size_t(int, double)>& level) {
  constexpr int kSweeps = 2000;
  double queue = 0.0;
  double value = 0.0;
  double last = level_quality(0);
  for (int i = 0; i < kSweeps; ++i) {
    const std::size_t now = level(i, queue);
    const double end = queue + static_cast<double>(kBytes[now]);
    const double quality = level_quality(now);
    value += quality - kQueueWeight * std::floor(end / sweep_bytes) - std::abs(quality - last);
    queue = std::max(0.0, end - sweep_bytes);
    last = quality;
  }
  return value / kSweeps;
}

TEST(LadderPlan, KeepsALevelThatFitsAndLeavesOneThatDoesNot) {
  EXPECT_EQ(LadderPlan(kBytes, 30'000).choose(0, 0), 0U);
  EXPECT_EQ(LadderPlan(kBytes, 7'500).choose(0, 3), 3U);
  EXPECT_EQ(LadderPlan(kBytes, 2'500).choose(0, 5), 5U);
  EXPECT_EQ(LadderPlan(kBytes, 10'000).choose(200'000, 0), 5U);
}

TEST(LadderPlan, IsWorthAsMuchAsTheBestTwoLevelsByTurns) {
  for (const double sweep_bytes : {10'000.0, 13'000.0, 16'000.0, 19'000.0}) {
    const LadderPlan plan(kBytes, sweep_bytes);
    std::size_t last = 0;
    const double planned =
        mean_worth(sweep_bytes, [&](int, double queue) { return last = plan.choose(queue, last); });
    double best = -1e300;
    for (std::size_t fine = 0; fine < kLevels; ++fine) {
      for (std::size_t coarse = fine; coarse < kLevels; ++coarse) {
        for (int m = 1; m <= 40; m += 3) {
          for (int n = 1; n <= 40; n += 3) {
            best = std::max(best, mean_worth(sweep_bytes, [&](int i, double) {
                              return i % (m + n) < m ? fine : coarse;
                            }));
          }
        }
      }
    }
    EXPECT_GE(planned, 0.97 * best) << sweep_bytes;
  }
}

}  // namespace
}  // namespace sweepcast
