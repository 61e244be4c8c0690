// What runs with vector instructions gives what plain code gives, to the last bit.
#include "codec/beam/prediction.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "core/random.hpp"

namespace sweepcast::beam {
namespace {

// Neighbours of a run, each range absent, near the others, or anywhere.
struct RandomRun {
  static constexpr std::size_t kCells = 1000;
  std::array<std::vector<std::int32_t>, Neighbours::kPlaces> range;
  std::array<std::vector<std::uint8_t>, Neighbours::kActive> activity;
  Neighbours neighbours{};

  RandomRun(std::mt19937& random, std::int32_t weight) {
    for (std::size_t place = 0; place < Neighbours::kPlaces; ++place) {
      for (std::size_t i = 0; i < kCells; ++i) {
        const std::uint32_t kind = test::random_bits(random) % 8;
        const auto near = static_cast<std::int32_t>(80'000 + test::random_bits(random) % 9'000);
        const auto any = static_cast<std::int32_t>(2'000 + test::random_bits(random) % 9'998'000);
        range[place].push_back(kind < 2 ? 0 : kind < 6 ? near : any);
      }
      neighbours.range[place] = range[place].data();
    }
    for (std::size_t place = 0; place < Neighbours::kActive; ++place) {
      for (std::size_t i = 0; i < kCells; ++i) {
        activity[place].push_back(static_cast<std::uint8_t>(test::random_bits(random) % 21));
      }
      neighbours.activity[place] = activity[place].data();
    }
    neighbours.weight = weight;
  }
};

TEST(Prediction, IsTheSameWithAndWithoutVectors) {
  std::mt19937 random(1);
  for (const std::int32_t step : {1, 40, 989, 20'000, 1 << 20}) {
    for (const std::int32_t weight : {1, 77, 128, 255}) {
      const RandomRun run(random, weight);
      const PredictionScale scale(step);
      Predictions fast, plain;
      Contexts fast_contexts, plain_contexts;
      for (auto* predictions : {&fast, &plain}) predictions->resize(RandomRun::kCells);
      for (auto* contexts : {&fast_contexts, &plain_contexts}) contexts->resize(RandomRun::kCells);
      predict(run.neighbours, scale, RandomRun::kCells, fast);
      plain::predict(run.neighbours, scale, RandomRun::kCells, plain);
      EXPECT_EQ(fast.range, plain.range);
      EXPECT_EQ(fast.carried, plain.carried);
      EXPECT_EQ(fast.spread, plain.spread);
      EXPECT_EQ(fast.basis, plain.basis);
      describe(run.neighbours, scale, fast, RandomRun::kCells, true, fast_contexts);
      plain::describe(run.neighbours, scale, fast, RandomRun::kCells, true, plain_contexts);
      EXPECT_EQ(fast_contexts.of, plain_contexts.of);
      EXPECT_EQ(fast_contexts.mean, plain_contexts.mean);
    }
  }
}

// Of a plane seen by a beam, inverse range is linear in the column: 1 / (1/2 (1/a + 1/b)).
TEST(Prediction, BetweenBothSidesOfAPlane) {
  const std::int32_t a = 100'000;
  const std::int32_t b = 103'000;
  const std::int32_t none = 0;
  const std::uint8_t quiet = 0;
  Neighbours at{};
  at.range.fill(&none);
  at.activity.fill(&quiet);
  at.range[Neighbours::a] = &a;
  at.range[Neighbours::b] = &b;
  Predictions found;
  found.resize(1);
  predict(at, PredictionScale(1000), 1, found);
  EXPECT_NEAR(found.range[0], 2.0 / (1.0 / a + 1.0 / b), 8.0);
  EXPECT_LT(found.range[0], (a + b) / 2);
  EXPECT_EQ(found.basis[0], static_cast<std::int32_t>(Basis::between));
  EXPECT_EQ(found.spread[0], 3'000);
}

}  // namespace
}  // namespace sweepcast::beam
