// A budget of bytes met on made-up relations between level and size.
#include "rate/byte_budget.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/random.hpp"
#include "rate/beam_quality.hpp"

namespace sweepcast {
namespace {

struct Outcome {
  std::optional<double> level;
  std::size_t size = 0;
  int tries = 0;
};

Outcome settle(ByteBudget& budget, const std::function<double(double)>& size_at) {
  Outcome outcome;
  const auto size = [&](double level) { return static_cast<std::size_t>(size_at(level)); };
  for (std::optional<double> level = budget.begin(); level; ++outcome.tries) {
    level = budget.next(size(*level));
  }
  outcome.level = budget.best();
  if (outcome.level) outcome.size = size(*outcome.level);
  return outcome;
}

TEST(ByteBudget, LandsWithinThreePerCentBelow) {
  std::mt19937 random(1);
  int close = 0;
  for (int i = 0; i < 500; ++i) {
    const double scale = std::exp(test::uniform_int(random, 90, 120) / 10.0);
    const double slope = -test::uniform_int(random, 15, 60) / 100.0;
    const double bend = test::uniform_int(random, -20, 20) / 1000.0;
    const auto size_at = [&](double level) {
      return scale * std::exp(slope * level + bend * std::sin(3.0 * level));
    };
    const auto target =
        static_cast<std::size_t>(size_at(test::uniform_int(random, -20, 60) / 10.0));
    ByteBudget budget(target);
    const Outcome outcome = settle(budget, size_at);
    ASSERT_TRUE(outcome.level.has_value());
    EXPECT_LE(outcome.size, target);
    EXPECT_LE(outcome.tries, 9);
    close += 100 * outcome.size >= 97 * target ? 1 : 0;
  }
  EXPECT_GE(close, 475);
}

TEST(ByteBudget, TheNextSweepBeginsWhereTheLastEnded) {
  ByteBudget budget(10'000);
  const auto size_at = [](double level) { return 30'000.0 * std::exp(-0.4 * level); };
  (void)settle(budget, size_at);
  EXPECT_EQ(settle(budget, size_at).tries, 1);
}

TEST(ByteBudget, SaysWhenNothingFits) {
  ByteBudget budget(10);
  EXPECT_FALSE(settle(budget, [](double) { return 500.0; }).level.has_value());
}

TEST(ByteBudget, ASweepThatFitsAtItsFinestIsGivenNoMoreTries) {
  ByteBudget budget(1'000'000);
  const Outcome outcome = settle(budget, [](double) { return 500.0; });
  EXPECT_EQ(outcome.level, kFinestLevel);
  EXPECT_LE(outcome.tries, 4);
}

TEST(ByteBudget, JumpsInSizeEndInTheLevelThatFits) {
  ByteBudget budget(1'000);
  const auto size_at = [](double level) { return level < 2.5 ? 2'000.0 : 100.0; };
  const Outcome outcome = settle(budget, size_at);
  ASSERT_TRUE(outcome.level.has_value());
  EXPECT_EQ(outcome.size, 100U);
}

}  // namespace
}  // namespace sweepcast
