// What effort best expects of a cell: the spread of errors, their offset, and points missed.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "codec/beam/error_spread.hpp"
#include "codec/beam/missed_points.hpp"
#include "codec/beam/offset_estimator.hpp"
#include "core/random.hpp"

namespace sweepcast::beam {
namespace {

double log_odds(double yes, double no) {
  return 256.0 * std::log(yes / no);
}

TEST(LogisticErrors, AreThoseOfTheDistribution) {
  for (const std::int32_t offset : {-20, 0, 7}) {
    for (const std::int32_t mean : {100, 256, 700}) {
      const LogisticErrors errors(offset, mean);
      // The chance of at most x steps; the mean size is 2 ln 2 times the scale.
      const double scale = mean / 256.0 / (2.0 * std::log(2.0));
      const auto below = [&](double x) {
        return 1.0 / (1.0 + std::exp(-(x - offset / 16.0) / scale));
      };
      const double zero = below(0.5) - below(-0.5);
      EXPECT_NEAR(errors.nonzero(), log_odds(1.0 - zero, zero), 8.0) << offset << ' ' << mean;
      EXPECT_NEAR(errors.negative(), log_odds(below(-0.5), 1.0 - below(0.5)), 8.0);
      for (const std::int32_t size : {1, 3}) {
        const double more = 1.0 - below(size + 0.5);
        EXPECT_NEAR(errors.more(size, 1), log_odds(more, 1.0 - below(size - 0.5) - more), 12.0);
        const double less = below(-size - 0.5);
        EXPECT_NEAR(errors.more(size, -1), log_odds(less, below(-size + 0.5) - less), 12.0);
      }
    }
  }
}

TEST(SpreadMemory, TendsToTheMeanOfWhatItSees) {
  SpreadMemory memory;
  std::mt19937 random(1);
  for (int i = 0; i < 500; ++i) memory.learn(static_cast<std::int32_t>(random() % 401));
  EXPECT_NEAR(memory.mean, 200, 40);
  for (int i = 0; i < 500; ++i) memory.learn(1'000'000);  // an outlier counts as the largest
  EXPECT_NEAR(memory.mean, SpreadMemory::kLargest, 70);
}

// A run in which every cell is off by as much as the cell across was.
TEST(OffsetEstimator, LearnsThatACellIsOffLikeTheOneAcross) {
  constexpr std::size_t kCells = 2000;
  std::mt19937 random(2);
  std::vector<std::int32_t> flat(kCells + 40, 100'000), across(flat), none(kCells + 40, 0);
  for (std::int32_t& range : across) range += static_cast<std::int32_t>(random() % 401) - 200;
  Neighbours at{};
  at.range.fill(none.data() + 16);
  for (const Neighbours::Place place :
       {Neighbours::a, Neighbours::b, Neighbours::na, Neighbours::nb}) {
    at.range[place] = flat.data() + 16;
  }
  at.range[Neighbours::n] = across.data() + 16;
  const PredictionScale scale(100);
  Predictions predictions;
  predictions.resize(kCells);
  std::fill(predictions.range.begin(), predictions.range.end(), 100'000);
  std::vector<std::int32_t> self(kCells, 0);
  OffsetEstimator estimator;
  estimator.reset();
  double before = 0.0;
  double after = 0.0;
  for (std::size_t i = 0; i < kCells; ++i) {
    const CellView cell{at, scale, predictions, i, self.data() + i, true, 5, 0};
    const std::int32_t offset = estimator.estimate(cell);
    const std::int32_t truth = (across[16 + i] - 100'000) * 16 / 100;
    if (i >= kCells / 2) {
      before += std::abs(truth);
      after += std::abs(truth - offset);
    }
    estimator.learn(truth - offset);
  }
  EXPECT_LT(after, 0.1 * before);
}

TEST(MissedCells, AreThoseWithNothingNearInThreeDimensions) {
  constexpr std::size_t kCols = 40;
  const std::vector<std::int32_t> elevation{1 << 20, 0};  // 1/16 apart
  std::vector<std::int32_t> truth(2 * kCols, 0), decoded(2 * kCols, 0);
  std::vector<CellState> state(2 * kCols, CellState::empty);
  const auto put = [&](std::size_t cell, std::int32_t range, CellState kind) {
    decoded[cell] = range;
    state[cell] = kind;
  };
  const auto missed = [&] {
    return missed_cells({kCols, 0.01, elevation, truth, decoded, state}, 10'000);  // 1 m
  };
  truth[20] = 100'000;  // 10 m
  EXPECT_EQ(missed(), std::vector<std::size_t>{20});
  put(20, 100'900, CellState::filled);
  EXPECT_TRUE(missed().empty());
  put(20, 100'900, CellState::assumed);  // no point
  EXPECT_EQ(missed(), std::vector<std::size_t>{20});
  put(20, 120'000, CellState::filled);  // 2 m behind
  EXPECT_EQ(missed(), std::vector<std::size_t>{20});
  put(29, 100'000, CellState::measured);  // 9 columns: 0.9 m to the side
  EXPECT_TRUE(missed().empty());
  decoded[29] = 106'000;  // and 0.6 m behind
  EXPECT_EQ(missed(), std::vector<std::size_t>{20});
  put(kCols + 20, 100'000, CellState::measured);  // 1/16 of 10 m below
  EXPECT_TRUE(missed().empty());
}

}  // namespace
}  // namespace sweepcast::beam
