#include "link/link_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace sweepcast {
namespace {

/// 1500 bytes every 10 ms, from 10 ms on.
Trace steady() {
  return {"steady", {10'000, 20'000, 30'000, 40'000, 50'000}, 50'000};
}

TEST(TraceLine, GoesRoundAndRound) {
  const Trace trace = steady();
  const TraceLine line(trace);
  for (std::int64_t k = 0; k < 23; ++k) {
    EXPECT_EQ(line.time_us(k), 10'000 * (k + 1));
    EXPECT_EQ(line.at(10'000 * (k + 1)).opportunity, k);
    EXPECT_EQ(line.at(10'000 * k + 1).opportunity, k);
  }
  EXPECT_EQ(line.at(0), (LinkPlace{0, 0}));
  EXPECT_EQ(TraceLine::after({3, 1000}, 700), (LinkPlace{4, 200}));
  EXPECT_EQ(line.sent_us({4, 200}), 50'000);
  EXPECT_EQ(line.sent_us({4, 0}), 40'000);
}

TEST(LinkModel, PacketsShareOpportunitiesAndWaitForEachOther) {
  const Trace trace = steady();
  LinkModel link(trace, {.delay_us = 7'000});
  const auto first = link.send(0, 1000);
  const auto second = link.send(0, 1000);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->sent_us, 10'000);
  EXPECT_EQ(first->arrives_us, 17'000);
  EXPECT_EQ(second->sent_us, 20'000);
  EXPECT_EQ(link.queued_bytes(0), 2000);
  EXPECT_EQ(link.queued_bytes(10'001), 500);
  EXPECT_EQ(link.queued_bytes(20'001), 0);
  // The rest of the opportunity at 20 ms is past: what comes then waits for the next.
  EXPECT_EQ(link.send(20'001, 100)->sent_us, 30'000);
  // Round after round.
  EXPECT_EQ(link.send(1'000'000, 1500)->sent_us, 1'000'000);
  EXPECT_EQ(link.send(1'000'000, 1500)->sent_us, 1'010'000);
}

TEST(LinkModel, RefusesWhatFindsNoRoom) {
  const Trace trace = steady();
  LinkModel link(trace, {.queue_limit = 3000});
  EXPECT_TRUE(link.send(0, 1400));
  EXPECT_TRUE(link.send(0, 1400));
  EXPECT_FALSE(link.send(0, 1400));
  EXPECT_TRUE(link.send(0, 200));
  EXPECT_TRUE(link.send(10'001, 1400));
}

TEST(LinkModel, ChancesAreAsAskedAndTheSameForASeed) {
  const Trace trace = steady();
  const LinkOptions options{
      .delay_us = 30'000, .jitter_us = 10'000, .loss = 0.02, .reordering = 0.05, .seed = 7};
  LinkModel link(trace, options);
  LinkModel again(trace, options);
  int lost = 0;
  int overtaken = 0;
  std::int64_t latest = 0;
  std::int64_t least = 1'000'000;
  for (int i = 1; i <= 20'000; ++i) {
    const std::int64_t now_us = 10'000 * i;
    const auto fate = link.send(now_us, 1000);
    ASSERT_TRUE(fate);
    EXPECT_EQ(fate->arrives_us, again.send(now_us, 1000)->arrives_us);
    if (!fate->arrives_us) {
      ++lost;
      continue;
    }
    if (*fate->arrives_us < latest) ++overtaken;
    latest = std::max(latest, *fate->arrives_us);
    const std::int64_t delay_us = *fate->arrives_us - fate->sent_us;
    least = std::min(least, delay_us);
    EXPECT_LE(delay_us, 60'000);
  }
  EXPECT_GE(least, 30'000);
  EXPECT_LT(least, 30'100);
  EXPECT_NEAR(lost, 400, 80);
  EXPECT_GT(overtaken, 500);  // of 980 that were held back 20 ms, those with another behind
}

TEST(LinkModel, WithoutReorderingJitterKeepsTheOrder) {
  const Trace trace = steady();
  LinkModel link(trace, {.jitter_us = 50'000});
  std::int64_t latest = 0;
  for (int i = 1; i <= 1000; ++i) {
    const auto arrival_us = link.send(10'000 * i, 1500)->arrives_us;
    ASSERT_TRUE(arrival_us);
    EXPECT_GE(*arrival_us, latest);
    latest = *arrival_us;
  }
}

TEST(LinkModel, RefusesOptionsThatCannotBe) {
  EXPECT_TRUE(check(LinkOptions{}));
  EXPECT_FALSE(check({.delay_us = -1}));
  EXPECT_FALSE(check({.jitter_us = 60'000'001}));
  EXPECT_FALSE(check({.loss = 1.1}));
  EXPECT_FALSE(check({.reordering = -0.1}));
  EXPECT_FALSE(check({.queue_limit = -1}));
}

}  // namespace
}  // namespace sweepcast
