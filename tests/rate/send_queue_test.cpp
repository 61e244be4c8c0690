#include "rate/send_queue.hpp"

#include <gtest/gtest.h>

namespace sweepcast {
namespace {

constexpr std::int64_t kPeriodUs = 100'000;

/// Takes up to `bytes` and returns what was taken, as in "1:0+500".
std::string take(SendQueue& queue, std::int64_t now_us, std::size_t bytes) {
  const auto piece = queue.next(now_us, bytes);
  if (!piece) return "";
  return std::to_string(piece->frame) + ":" + std::to_string(piece->begin) + "+" +
         std::to_string(piece->bytes);
}

TEST(SendQueue, OldestFirstSendsEveryByteInOrder) {
  SendQueue queue(SendOrder::oldest_first);
  queue.push(1, {300, 700}, 0);
  queue.push(2, {100}, kPeriodUs);
  EXPECT_EQ(queue.frames(), 2U);
  EXPECT_EQ(queue.bytes(), 800U);
  EXPECT_EQ(take(queue, kPeriodUs, 500), "1:0+500");
  EXPECT_EQ(take(queue, 1000 * kPeriodUs, 500), "1:500+200");
  EXPECT_FALSE(queue.contains(1));
  EXPECT_EQ(take(queue, 1000 * kPeriodUs, 500), "2:0+100");
  EXPECT_EQ(take(queue, 1000 * kPeriodUs, 500), "");
}

TEST(SendQueue, AFrameOfWhichLayersAreSentEndsWhereAFresherOneComes) {
  SendQueue queue(SendOrder::freshest_first);
  queue.push(1, {300, 700}, 0);
  EXPECT_EQ(take(queue, 0, 400), "1:0+400");
  queue.push(2, {200}, kPeriodUs);
  EXPECT_EQ(take(queue, kPeriodUs, 400), "2:0+200");
  EXPECT_EQ(take(queue, kPeriodUs, 400), "");
}

TEST(SendQueue, AFirstLayerThatHasBegunIsFinishedAlone) {
  SendQueue queue(SendOrder::freshest_first);
  queue.push(1, {300, 700}, 0);
  EXPECT_EQ(take(queue, 0, 100), "1:0+100");
  queue.push(2, {200}, kPeriodUs);
  EXPECT_EQ(take(queue, kPeriodUs, 400), "1:100+200");
  EXPECT_EQ(take(queue, kPeriodUs, 400), "2:0+200");
  EXPECT_EQ(queue.frames(), 0U);
}

TEST(SendQueue, ButNotWhereItIsTooOld) {
  SendQueue queue(SendOrder::freshest_first);
  queue.push(1, {300, 700}, 0);
  EXPECT_EQ(take(queue, 0, 100), "1:0+100");
  const std::int64_t now_us = SendQueue::kFinishUs + 1;
  queue.push(2, {200}, now_us);
  EXPECT_EQ(take(queue, now_us, 400), "2:0+200");
  EXPECT_EQ(take(queue, now_us, 400), "1:100+400");  // in spare time
}

TEST(SendQueue, WhatIsOvertakenWaitsCutToItsFirstLayers) {
  SendQueue queue(SendOrder::freshest_first);
  queue.push(1, {100, 200, 300, 400, 500}, 0);
  queue.push(2, {10, 20, 30, 40, 50}, kPeriodUs);
  queue.push(3, {7}, 2 * kPeriodUs);
  EXPECT_EQ(queue.frames(), 3U);
  EXPECT_EQ(take(queue, 2 * kPeriodUs, 1000), "3:0+7");
  EXPECT_EQ(take(queue, 2 * kPeriodUs, 1000), "2:0+30");
  EXPECT_EQ(take(queue, 2 * kPeriodUs, 1000), "1:0+300");
}

TEST(SendQueue, WhatIsLateTooLongIsGivenUp) {
  SendQueue queue(SendOrder::freshest_first);
  queue.push(1, {100}, 0);
  queue.push(2, {100}, kPeriodUs);
  EXPECT_EQ(take(queue, SendQueue::kLateUs + 1, 100), "2:0+100");
  EXPECT_EQ(queue.frames(), 0U);
  EXPECT_EQ(queue.bytes(), 0U);
}

}  // namespace
}  // namespace sweepcast
