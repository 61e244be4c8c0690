#include "rate/send_queue.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace sweepcast {
namespace {

constexpr std::int64_t kPeriodUs = 100'000;
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

/// A queue in the hands of a test. Of the frames' layers three wait where they are overtaken.
class SendQueueTest : public ::testing::Test {
 protected:
  explicit SendQueueTest(SendOrder order = SendOrder::freshest_first) : queue_(order, 3) {}

  void push(std::uint64_t frame, std::vector<std::size_t> ends, std::int64_t deadline_us = kNever,
            std::uint8_t stream = 0) {
    queue_.push({frame, stream, std::move(ends), deadline_us}, now_us_);
  }
  /// Takes up to `bytes` and returns what was taken, as in "1:0+500"; empty where nothing is left.
  std::string take(std::size_t bytes) {
    const auto next = queue_.next(now_us_);
    if (!next) return "";
    bytes = std::min(bytes, next->end - next->begin);
    queue_.take(bytes);
    return std::to_string(next->frame) + ":" + std::to_string(next->begin) + "+" +
           std::to_string(bytes);
  }
  void expect_takes(std::size_t bytes, std::initializer_list<const char*> expected) {
    for (const char* what : expected) EXPECT_EQ(take(bytes), what);
    EXPECT_EQ(take(bytes), "");
    EXPECT_EQ(queue_.frames(), 0U);
    EXPECT_EQ(queue_.bytes(), 0U);
  }
  void expect_counts(std::uint64_t sent, std::uint64_t cut, std::uint64_t dropped) const {
    EXPECT_EQ(queue_.counts().sent, sent);
    EXPECT_EQ(queue_.counts().cut, cut);
    EXPECT_EQ(queue_.counts().dropped, dropped);
  }

  std::int64_t now_us_ = 0;
  SendQueue queue_;
};

class OldestFirst : public SendQueueTest {
 protected:
  OldestFirst() : SendQueueTest(SendOrder::oldest_first) {}
};

TEST_F(OldestFirst, SendsEveryByteInOrder) {
  push(1, {300, 700});
  now_us_ = kPeriodUs;
  push(2, {100});
  EXPECT_EQ(queue_.frames(), 2U);
  EXPECT_EQ(queue_.bytes(), 800U);
  EXPECT_EQ(take(500), "1:0+500");
  now_us_ = 1000 * kPeriodUs;
  EXPECT_TRUE(queue_.contains(1));
  expect_takes(500, {"1:500+200", "2:0+100"});
  EXPECT_FALSE(queue_.contains(1));
  expect_counts(2, 0, 0);
}

TEST_F(OldestFirst, GivesUpAtTheDeadline) {
  push(1, {300, 700}, 10);
  push(2, {300, 700}, 11);
  push(3, {300, 700}, 12);
  EXPECT_EQ(take(500), "1:0+500");
  now_us_ = 11;
  expect_takes(1000, {"3:0+700"});
  expect_counts(1, 1, 1);
}

TEST_F(SendQueueTest, TellsTheLayerAtHand) {
  push(1, {300, 700, 900});
  EXPECT_EQ(take(300), "1:0+300");
  const auto next = queue_.next(0);
  ASSERT_TRUE(next);
  EXPECT_EQ(next->layer, 1U);
  EXPECT_EQ(next->begin, 300U);
  EXPECT_EQ(next->layer_end, 700U);
  EXPECT_EQ(next->end, 900U);
}

TEST_F(SendQueueTest, AFrameOfWhichLayersAreSentEndsWhereAFresherOneComes) {
  push(1, {300, 700});
  EXPECT_EQ(take(400), "1:0+400");
  now_us_ = kPeriodUs;
  push(2, {200});
  expect_takes(400, {"2:0+200"});
  expect_counts(1, 1, 0);
}

TEST_F(SendQueueTest, AFirstLayerThatHasBegunIsFinishedAlone) {
  push(1, {300, 700});
  EXPECT_EQ(take(100), "1:0+100");
  now_us_ = kPeriodUs;
  push(2, {200});
  expect_takes(400, {"1:100+200", "2:0+200"});
  expect_counts(1, 1, 0);
}

TEST_F(SendQueueTest, ButNotWhereItIsTooOld) {
  push(1, {300, 700});
  EXPECT_EQ(take(100), "1:0+100");
  now_us_ = SendQueue::kFinishUs + 1;
  push(2, {200});
  expect_takes(400, {"2:0+200", "1:100+400", "1:500+200"});  // in spare time
}

TEST_F(SendQueueTest, WhatIsOvertakenWaitsCutToItsFirstLayers) {
  push(1, {100, 200, 300, 400, 500});
  push(2, {10, 20, 30, 40, 50});
  push(3, {7});
  EXPECT_EQ(queue_.frames(), 3U);
  expect_takes(1000, {"3:0+7", "2:0+30", "1:0+300"});
  expect_counts(1, 2, 0);
}

TEST_F(SendQueueTest, OrIsDroppedWhereNothingMayBeLate) {
  SendQueue strict(SendOrder::freshest_first);
  strict.push({1, 0, {100, 200}, kNever}, 0);
  strict.push({2, 0, {100, 200}, kNever}, 0);
  EXPECT_EQ(strict.next(0)->frame, 2U);
  EXPECT_EQ(strict.frames(), 1U);
  EXPECT_EQ(strict.counts().dropped, 1U);
}

TEST_F(SendQueueTest, WhatIsLateTooLongIsGivenUp) {
  push(1, {100}, kPeriodUs);
  push(2, {100}, 2 * kPeriodUs);
  now_us_ = kPeriodUs;
  expect_takes(100, {"2:0+100"});
  expect_counts(1, 0, 1);
}

TEST_F(SendQueueTest, StreamsShareLayerByLayer) {
  push(1, {200, 300}, kNever, 0);
  push(2, {100, 200}, kNever, 1);
  expect_takes(100, {"2:0+100", "1:0+100", "1:100+100", "2:100+100", "1:200+100"});
}

TEST_F(SendQueueTest, AFrameOvertakesThoseOfItsOwnStreamAlone) {
  push(1, {100, 200, 300, 400}, kNever, 0);
  push(2, {100}, kNever, 1);
  push(3, {100}, kNever, 1);
  expect_takes(1000, {"3:0+100", "1:0+400", "2:0+100"});
}

}  // namespace
}  // namespace sweepcast
