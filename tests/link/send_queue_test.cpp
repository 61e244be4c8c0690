#include "link/send_queue.hpp"

#include "link/support.hpp"

namespace sweepcast::link {
namespace {

using test::Bytes;
using test::bytes_of;

std::vector<Bytes> layers(std::initializer_list<std::size_t> fragments) {
  std::vector<Bytes> out;
  for (const std::size_t count : fragments) out.push_back(bytes_of(count * kFragmentPayload));
  return out;
}

/// "stream/sweep/layer/index" of what leaves next; empty where nothing does.
std::string take(SendQueue& queue, Microseconds now = 0) {
  const auto fragment = queue.peek(now);
  if (!fragment) return "";
  queue.pop();
  return std::to_string(fragment->stream) + "/" + std::to_string(fragment->sweep) + "/" +
         std::to_string(fragment->layer) + "/" + std::to_string(fragment->index);
}

TEST(SendQueue, LayersLeaveCoarsestFirst) {
  SendQueue queue;
  auto sweep = layers({2, 1});
  sweep[1].resize(5);
  queue.push(3, sweep, 100'500);
  EXPECT_EQ(queue.queued_bytes(), 2 * kFragmentPayload + 5);
  const auto first = queue.peek(400);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->remaining_ms, 101);
  EXPECT_EQ(first->sent_us, 400U);
  EXPECT_EQ(first->layers, 2);
  EXPECT_EQ(first->payload.size(), kFragmentPayload);
  EXPECT_EQ(take(queue), "3/1/0/0");
  EXPECT_EQ(queue.queued_bytes(), kFragmentPayload + 5);
  EXPECT_EQ(take(queue), "3/1/0/1");
  EXPECT_EQ(queue.peek(0)->payload.size(), 5U);
  EXPECT_EQ(take(queue), "3/1/1/0");
  EXPECT_EQ(take(queue), "");
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.counts().sent, 1U);
}

TEST(SendQueue, ANewerSweepEndsTheOlderAfterTheLayerAtHand) {
  SendQueue queue;
  queue.push(0, layers({2, 2, 2}), 1000);
  EXPECT_EQ(take(queue), "0/1/0/0");
  queue.push(0, layers({1, 1}), 1000);
  queue.push(0, layers({1, 1}), 1000);  // the second never began
  EXPECT_EQ(queue.queued_bytes(), 3 * kFragmentPayload);
  for (const char* next : {"0/1/0/1", "0/3/0/0", "0/3/1/0", ""}) EXPECT_EQ(take(queue), next);
  EXPECT_EQ(queue.counts().cut, 1U);
  EXPECT_EQ(queue.counts().dropped, 1U);
  EXPECT_EQ(queue.counts().sent, 1U);
}

TEST(SendQueue, BetweenLayersItEndsAtOnce) {
  SendQueue queue;
  queue.push(0, layers({1, 1}), 1000);
  EXPECT_EQ(take(queue), "0/1/0/0");
  queue.push(0, layers({1}), 1000);
  EXPECT_EQ(take(queue), "0/2/0/0");
  EXPECT_EQ(queue.counts().cut, 1U);
}

TEST(SendQueue, AtItsDeadlineASweepEndsWhereItIs) {
  SendQueue queue;
  queue.push(0, layers({1, 2}), 1000);
  queue.push(1, layers({1}), 1000);
  EXPECT_EQ(take(queue, 999), "1/1/0/0");
  EXPECT_EQ(take(queue, 999), "0/1/0/0");
  EXPECT_EQ(take(queue, 999), "0/1/1/0");
  EXPECT_EQ(take(queue, 1000), "");
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.counts().cut, 1U);
  EXPECT_EQ(queue.counts().sent, 1U);
}

TEST(SendQueue, SensorsShareLayerByLayer) {
  SendQueue queue;
  queue.push(0, layers({2, 1}), 1000);
  queue.push(1, layers({1, 1}), 1000);
  std::vector<std::string> order;
  for (std::string next = take(queue); !next.empty(); next = take(queue)) order.push_back(next);
  EXPECT_EQ(order,
            (std::vector<std::string>{"1/1/0/0", "0/1/0/0", "0/1/0/1", "1/1/1/0", "0/1/1/0"}));
}

TEST(SendQueue, ClearDropsAll) {
  SendQueue queue;
  queue.push(0, layers({2, 1}), 1000);
  EXPECT_EQ(take(queue), "0/1/0/0");
  queue.push(0, layers({2, 1}), 1000);
  queue.clear();
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.queued_bytes(), 0U);
  EXPECT_EQ(queue.counts().dropped, 2U);
}

}  // namespace
}  // namespace sweepcast::link
