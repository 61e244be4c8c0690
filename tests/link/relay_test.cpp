// The live link through the relay: loss, delay, jitter and reordering on 127.0.0.1.
#include "link/relay.hpp"

#include <condition_variable>
#include <mutex>
#include <thread>

#include "link/support.hpp"
#include "sweepcast/decoder.hpp"
#include "sweepcast/link.hpp"

namespace sweepcast::test {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

/// 1 MB/s.
Trace steady_trace() {
  Trace trace;
  trace.name = "steady";
  trace.opportunities_us = {1500};
  trace.period_us = 1500;
  return trace;
}

TEST(Relay, ALossyLinkDeliversNearlyAllAndNothingDamaged) {
  const std::vector<Bytes> frames = small_frames(20);
  const LinkKey key = *make_link_key("rover");
  std::mutex mutex;
  std::condition_variable came;
  std::vector<Bytes> received;
  ReceiverOptions receiver_options;
  receiver_options.keys = {key};
  receiver_options.on_sweep = [&](const ReceivedSweep& sweep) {
    const std::scoped_lock lock(mutex);
    received.emplace_back(sweep.frame.begin(), sweep.frame.end());
    came.notify_all();
  };
  auto receiver = Receiver::start(receiver_options);
  ASSERT_TRUE(receiver);

  RelayOptions relay_options;
  relay_options.to_port = receiver->port();
  relay_options.trace = steady_trace();
  relay_options.link = {10'000, 5'000, 0.05, 0.02, 5'000, 0, 3};
  auto relay = Relay::start(relay_options);
  ASSERT_TRUE(relay) << relay.error().message;

  SenderOptions sender_options;
  sender_options.port = relay->port();
  sender_options.key = key;
  sender_options.deadline = 5000ms;
  sender_options.strategy = "fixed:0";  // every frame whole
  auto sender = Sender::start(sender_options);
  ASSERT_TRUE(sender);
  // The next sweep goes out when the one before is there: none is replaced, on a slow machine too.
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_TRUE(sender->send({frames[i], "roof", std::to_string(i), steady_clock::now()}));
    std::unique_lock lock(mutex);
    ASSERT_TRUE(came.wait_for(lock, 10s, [&] { return received.size() == i + 1; })) << i;
  }
  for (const Bytes& frame : received) {
    PointCloud cloud;
    ASSERT_TRUE(Decoder().decode(frame, cloud));
    EXPECT_GT(cloud.size(), 4000U);
  }
  EXPECT_GT(relay->counts().lost, 0U);
  EXPECT_EQ(receiver->status().sweeps_whole, frames.size());
  EXPECT_EQ(receiver->status().packets_forged, 0U);
}

TEST(Relay, OptionsAreChecked) {
  RelayOptions options;
  EXPECT_FALSE(Relay::start(options));  // no trace
  options.trace = steady_trace();
  options.to_address = "example";
  EXPECT_FALSE(Relay::start(options));
  options.to_address = "127.0.0.1";
  options.link.loss = 2;
  EXPECT_FALSE(Relay::start(options));
  options.link.loss = 0;
  auto first = Relay::start(options);
  ASSERT_TRUE(first);
  options.listen_port = first->port();
  EXPECT_FALSE(Relay::start(options));
}

}  // namespace
}  // namespace sweepcast::test
