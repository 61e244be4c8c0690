#include "link/outbox.hpp"

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

/// "stream/sweep/layer/index" of all that leaves.
std::vector<std::string> take_all(Outbox& outbox, Microseconds now = 0) {
  std::vector<std::string> out;
  while (const auto fragment = outbox.peek(now)) {
    outbox.pop();
    out.push_back(std::to_string(fragment->stream) + "/" + std::to_string(fragment->sweep) + "/" +
                  std::to_string(fragment->layer) + "/" + std::to_string(fragment->index));
  }
  return out;
}

using Names = std::vector<std::string>;

TEST(Outbox, FragmentsSayWhereTheyBelong) {
  Outbox outbox(SendOrder::freshest_first);
  auto sweep = layers({2, 1});
  sweep[1].resize(5);
  outbox.push(3, sweep, 100'500, 0);
  const auto first = outbox.peek(400);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->remaining_ms, 101);
  EXPECT_EQ(first->sent_us, 400U);
  EXPECT_EQ(first->layers, 2);
  EXPECT_EQ(first->layer_bytes, 2 * kFragmentPayload);
  outbox.pop();
  Bytes got(first->payload.begin(), first->payload.end());
  const auto second = outbox.peek(400);
  got.insert(got.end(), second->payload.begin(), second->payload.end());
  EXPECT_EQ(got, sweep[0]);
  outbox.pop();
  const auto third = outbox.peek(400);
  EXPECT_EQ(third->layer, 1);
  EXPECT_EQ(third->index, 0);
  EXPECT_EQ(Bytes(third->payload.begin(), third->payload.end()), sweep[1]);
  outbox.pop();
  EXPECT_FALSE(outbox.peek(400));
  EXPECT_EQ(outbox.queue().counts().sent, 1U);
}

TEST(Outbox, ANewerSweepTakesTheOldersPlace) {
  Outbox outbox(SendOrder::freshest_first);
  outbox.push(0, layers({2, 2}), 1000, 0);
  outbox.push(0, layers({1, 1}), 1000, 0);  // the first never began
  ASSERT_TRUE(outbox.peek(0));
  outbox.pop();
  outbox.push(0, layers({1}), 1000, 0);
  EXPECT_EQ(take_all(outbox), (Names{"0/3/0/0"}));
  EXPECT_EQ(outbox.queue().counts().cut, 1U);
  EXPECT_EQ(outbox.queue().counts().dropped, 1U);
}

TEST(Outbox, AQueueKeepsAllUntilTheirDeadline) {
  Outbox outbox(SendOrder::oldest_first);
  outbox.push(0, layers({1, 1}), 1000, 0);
  outbox.push(0, layers({1}), 2000, 100);
  outbox.push(0, layers({1}), 3000, 200);
  ASSERT_TRUE(outbox.peek(999));
  outbox.pop();
  EXPECT_EQ(take_all(outbox, 1000), (Names{"0/2/0/0", "0/3/0/0"}));
  EXPECT_EQ(outbox.queue().counts().cut, 1U);
  EXPECT_EQ(outbox.queue().counts().sent, 2U);
}

TEST(Outbox, TheQoeIsOfWhatLeft) {
  Outbox outbox(SendOrder::oldest_first);
  EXPECT_FALSE(outbox.qoe());
  outbox.push(0, layers({1}), 1000, 0, 1);
  (void)take_all(outbox);  // 20
  EXPECT_NEAR(*outbox.qoe(), 20.0, 1e-12);
  outbox.push(0, layers({2}), 1000, 0, 1);  // will not leave
  outbox.push(1, layers({1}), 9000, 0, 5);  // another sensor's: 0, and no queue before it
  outbox.push(0, layers({1}), 9000, 0, 2);  // 15, one frame before it
  ASSERT_TRUE(outbox.peek(0));
  outbox.pop();
  (void)take_all(outbox, 1000);
  EXPECT_EQ(outbox.queue().counts().dropped, 1U);
  // 20, 0 after a fall of 20, 15 less 0.5 after a rise of 15; the other sensor's 0.
  EXPECT_NEAR(*outbox.qoe(), ((20.0 - 20.0 - 0.5) / 3.0 + 0.0) / 2.0, 1e-12);
  outbox.push(0, layers({1}), 9000, 1000);  // of no level
  (void)take_all(outbox, 1000);
  EXPECT_NEAR(*outbox.qoe(), 0.0, 1e-12);
}

TEST(Outbox, ClearDropsAll) {
  Outbox outbox(SendOrder::oldest_first);
  outbox.push(0, layers({2, 1}), 1000, 0);
  outbox.push(1, layers({2, 1}), 1000, 0);
  outbox.clear();
  EXPECT_FALSE(outbox.peek(0));
  EXPECT_EQ(outbox.queue().bytes(), 0U);
  EXPECT_EQ(outbox.queue().counts().dropped, 2U);
}

}  // namespace
}  // namespace sweepcast::link
