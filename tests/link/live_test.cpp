// Sender and receiver over SRT on 127.0.0.1.
#include <gtest/gtest.h>

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "link/relay.hpp"
#include "link/support.hpp"
#include "sweepcast/decoder.hpp"
#include "sweepcast/link.hpp"

namespace sweepcast::test {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

/// What a receiver delivered, from its own thread.
class Mailbox {
 public:
  struct Letter {
    std::string from;  ///< robot/sensor/name
    Bytes frame;
    int layers = 0;
  };

  [[nodiscard]] std::function<void(const ReceivedSweep&)> slot() {
    return [this](const ReceivedSweep& sweep) {
      const std::scoped_lock lock(mutex_);
      letters_.push_back({std::string(sweep.robot) + "/" + std::string(sweep.sensor) + "/" +
                              std::string(sweep.name),
                          {sweep.frame.begin(), sweep.frame.end()},
                          sweep.layers});
      came_.notify_all();
    };
  }

  /// Waits, for at most 10 s, until there are so many letters; gives them.
  std::vector<Letter> wait_for(std::size_t count) {
    std::unique_lock lock(mutex_);
    came_.wait_for(lock, 10s, [&] { return letters_.size() >= count; });
    return letters_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable came_;
  std::vector<Letter> letters_;
};

/// Asks again and again, for at most 10 s.
bool eventually(const std::function<bool()>& condition) {
  const auto end = steady_clock::now() + 10s;
  while (!condition()) {
    if (steady_clock::now() > end) return false;
    std::this_thread::yield();
  }
  return true;
}

class Live : public ::testing::Test {
 protected:
  [[nodiscard]] Receiver receiver(std::uint16_t port, std::vector<LinkKey> keys) {
    ReceiverOptions options;
    options.port = port;
    options.keys = std::move(keys);
    options.on_sweep = mailbox_.slot();
    auto started = Receiver::start(options);
    EXPECT_TRUE(started) << started.error().message;
    return std::move(*started);
  }

  [[nodiscard]] static Sender sender(std::uint16_t port, const LinkKey& key) {
    SenderOptions options;
    options.port = port;
    options.key = key;
    options.deadline = 5000ms;     // nothing is dropped on a slow machine
    options.strategy = "fixed:0";  // and all are sent
    auto started = Sender::start(options);
    EXPECT_TRUE(started) << started.error().message;
    return std::move(*started);
  }

  static void send(Sender& sender, const Bytes& frame, const std::string& sensor,
                   const std::string& name) {
    const Status sent = sender.send({frame, sensor, name, steady_clock::now()});
    EXPECT_TRUE(sent) << sent.error().message;
  }

  Mailbox mailbox_;
  const LinkKey rover_ = *make_link_key("rover");
  const LinkKey mole_ = *make_link_key("mole");
};

TEST_F(Live, SweepsArriveFromManyRobotsAndSensors) {
  const std::vector<Bytes> frames = small_frames(4);
  Receiver server = receiver(0, {rover_, mole_});
  Sender one = sender(server.port(), rover_);
  Sender two = sender(server.port(), mole_);
  ASSERT_TRUE(eventually([&] { return one.status().connected && two.status().connected; }));
  std::size_t letters = 0;
  for (int i = 0; i < 4; ++i) {
    const Bytes& frame = frames[static_cast<std::size_t>(i)];
    send(one, frame, "roof", "r" + std::to_string(i));
    send(one, frame, "rear", "b" + std::to_string(i));
    send(two, frame, "roof", "m" + std::to_string(i));
    letters += 3;
    ASSERT_EQ(mailbox_.wait_for(letters).size(), letters) << server.status().sweeps_missed;
  }
  std::map<std::string, PointCloud> clouds;
  for (const auto& letter : mailbox_.wait_for(letters)) {
    EXPECT_EQ(letter.layers, 5);
    ASSERT_TRUE(Decoder().decode(letter.frame, clouds[letter.from])) << letter.from;
  }
  Decoder decoder;
  for (int i = 0; i < 4; ++i) {
    PointCloud truth;
    ASSERT_TRUE(decoder.decode(frames[static_cast<std::size_t>(i)], truth));
    for (const char* from : {"rover/roof/r", "rover/rear/b", "mole/roof/m"}) {
      EXPECT_EQ(clouds[from + std::to_string(i)].x, truth.x) << from << i;
    }
  }
  EXPECT_TRUE(eventually([&] { return server.status().peers == 2; }));
  EXPECT_TRUE(eventually([&] { return one.status().reports > 2; }));
  const ReceiverStatus status = server.status();
  EXPECT_EQ(status.sweeps_whole, 12U);
  EXPECT_EQ(status.packets_forged + status.packets_malformed + status.packets_replayed, 0U);
  EXPECT_GE(status.newest_age_s, 0.0);
  EXPECT_LT(status.newest_age_s, 5.0);
  EXPECT_EQ(one.status().sweeps_sent, 8U);
}

TEST_F(Live, ARestartedReceiverIsFoundAgain) {
  const std::vector<Bytes> frames = small_frames(2);
  std::optional<Receiver> server = receiver(0, {rover_});
  const std::uint16_t port = server->port();
  Sender robot = sender(port, rover_);
  ASSERT_TRUE(eventually([&] { return robot.status().connected; }));
  send(robot, frames[0], "roof", "before");
  ASSERT_EQ(mailbox_.wait_for(1).size(), 1U);
  server.reset();
  ASSERT_TRUE(eventually([&] { return !robot.status().connected; }));
  server = receiver(port, {rover_});
  ASSERT_TRUE(eventually([&] { return robot.status().connected; }));
  send(robot, frames[1], "roof", "after");  // lacks the model, which the sender adds
  const auto letters = mailbox_.wait_for(2);
  ASSERT_EQ(letters.size(), 2U);
  PointCloud cloud;
  EXPECT_EQ(letters[1].from, "rover/roof/after");
  EXPECT_TRUE(Decoder().decode(letters[1].frame, cloud));
  EXPECT_FALSE(cloud.empty());
  EXPECT_EQ(robot.status().connections, 2U);
}

TEST_F(Live, WrongAndUnknownKeysAreRefused) {
  Receiver server = receiver(0, {rover_});
  LinkKey wrong = rover_;
  wrong.secret[0] ^= 1;
  Sender forger = sender(server.port(), wrong);
  Sender stranger = sender(server.port(), mole_);
  ASSERT_TRUE(eventually([&] { return server.status().connections_refused >= 4; }));
  EXPECT_TRUE(eventually([&] {
    return forger.status().error.find("key") != std::string::npos &&
           stranger.status().error.find("key") != std::string::npos;
  }));
  EXPECT_EQ(forger.status().connections + stranger.status().connections, 0U);
  EXPECT_EQ(server.status().peers, 0U);
  EXPECT_EQ(server.status().packets, 0U);
  Sender robot = sender(server.port(), rover_);  // whom they do not disturb
  ASSERT_TRUE(eventually([&] { return robot.status().connected; }));
}

TEST_F(Live, PeersAreLimited) {
  ReceiverOptions options;
  options.keys = {rover_, mole_};
  options.most_peers = 1;
  auto server = Receiver::start(options);
  ASSERT_TRUE(server);
  std::optional<Sender> first = sender(server->port(), rover_);
  ASSERT_TRUE(eventually([&] { return first->status().connected; }));
  Sender second = sender(server->port(), mole_);
  ASSERT_TRUE(eventually([&] { return server->status().connections_refused > 0; }));
  EXPECT_FALSE(second.status().connected);
  first.reset();
  EXPECT_TRUE(eventually([&] { return second.status().connected; }));
}

TEST_F(Live, FinishWaitsUntilAllHasArrived) {
  const Bytes frame = small_frames(1).front();
  Receiver server = receiver(0, {rover_});
  {
    Sender robot = sender(server.port(), rover_);
    ASSERT_TRUE(eventually([&] { return robot.status().connected; }));
    send(robot, frame, "roof", "last");
    robot.finish();
    EXPECT_EQ(robot.status().sweeps_sent, 1U);
  }
  EXPECT_EQ(mailbox_.wait_for(1).size(), 1U);
}

/// The budgets that a sender chooses while it sends frames, as large as each says, through a relay
/// of a given rate, until `enough` of the choices so far. Frames are cut to their budget by layers.
class Choices : public Live {
 protected:
  std::vector<std::size_t> choose(
      double bytes_per_s, const std::function<bool(const std::vector<std::size_t>&)>& enough) {
    Receiver server = receiver(0, {rover_});
    RelayOptions between;
    between.to_port = server.port();
    between.trace = steady_trace(bytes_per_s);
    between.link.delay_us = 5'000;
    auto relay = Relay::start(between);
    EXPECT_TRUE(relay);
    SenderOptions options;
    options.port = relay->port();
    options.key = rover_;
    auto robot = Sender::start(options);
    EXPECT_TRUE(robot);
    EXPECT_TRUE(eventually([&] { return robot->status().connected; }));
    const Bytes frame = large_frame();
    std::vector<std::size_t> choices;
    const auto end = steady_clock::now() + 60s;
    for (auto due = steady_clock::now(); !enough(choices) && due < end; due += 100ms) {
      std::this_thread::sleep_until(due);  // a sensor's own time
      const LinkBudget budget = robot->choose();
      EXPECT_FALSE(budget.level);
      choices.push_back(budget.sweep_bytes);
      EXPECT_TRUE(robot->send({frame, "roof", "", due, budget.sweep_bytes}));
    }
    EXPECT_TRUE(enough(choices)) << choices.size() << " choices, the last " << choices.back();
    return choices;
  }
};

TEST_F(Choices, BudgetGrowsToItsMostOnAFastLinkByNoMoreThanAFifthASweep) {
  const auto choices =
      choose(20e6, [](const auto& all) { return !all.empty() && all.back() == 45'000; });
  for (std::size_t i = 1; i < choices.size(); ++i) {
    EXPECT_LE(static_cast<double>(choices[i]), 1.2 * static_cast<double>(choices[i - 1]) + 1.0);
  }
}

TEST_F(Choices, BudgetStaysSmallOnASlowLink) {
  const auto choices = choose(60e3, [](const auto& all) { return all.size() == 50; });
  // 0.8 of 6 kB, two thirds of it for the time that is left; with room for a busy machine.
  for (std::size_t i = 20; i < choices.size(); ++i) EXPECT_LE(choices[i], 7'000U) << i;
}

/// A sender whose strategy is level 1, before a receiver, and what it sends at each level.
class Overridden : public Live {
 protected:
  void begin(bool allow) {
    server_ = receiver(0, {rover_});
    SenderOptions options;
    options.port = server_->port();
    options.key = rover_;
    options.deadline = 5000ms;
    options.strategy = "fixed:1";
    options.allow_override = allow;
    auto started = Sender::start(options);
    ASSERT_TRUE(started) << started.error().message;
    robot_ = std::move(*started);
    ASSERT_TRUE(eventually([&] { return report().has_value(); }));
    const PointCloud cloud = spinning_sweep(16, 360, 7);
    for (int level = 0; level < 6; ++level) {
      EncoderOptions how;
      how.beam.level = level;
      auto encoder = Encoder::create(how);
      const auto frame = encoder->encode(cloud, {});
      frames_.emplace_back(frame->begin(), frame->end());
    }
  }
  /// What the receiver knows of the sender.
  std::optional<SenderReport> report() {
    const auto robots = server_->robots();
    if (robots.empty() || !robots.front().connected) return std::nullopt;
    EXPECT_EQ(robots.front().robot, "rover");
    return robots.front().report;
  }
  /// Sends one sweep as a sender has to, and gives the frame that arrives.
  Bytes send_one() {
    const LinkBudget budget = robot_->choose();
    EXPECT_TRUE(budget.level);
    const std::size_t level = budget.level.value_or(0);
    EXPECT_TRUE(robot_->send({frames_.at(level), "roof", "", steady_clock::now(), 0, level}));
    const auto letters = mailbox_.wait_for(++sent_);
    return letters.size() == sent_ ? letters.back().frame : Bytes();
  }

  std::optional<Receiver> server_;
  std::optional<Sender> robot_;
  std::vector<Bytes> frames_;
  std::size_t sent_ = 0;
};

TEST_F(Overridden, AnOverrideChangesWhatIsSentUntilItIsTakenBack) {
  begin(true);
  EXPECT_TRUE(report()->can_override);
  EXPECT_EQ(send_one(), frames_[1]);
  ASSERT_TRUE(server_->ask_level("rover", 4));
  ASSERT_TRUE(eventually([&] { return report() && report()->override_level == 4U; }));
  EXPECT_EQ(send_one(), frames_[4]);
  ASSERT_TRUE(eventually([&] { return report() && report()->level == 4U; }));
  ASSERT_TRUE(server_->ask_level("rover", std::nullopt));
  ASSERT_TRUE(eventually([&] { return report() && !report()->override_level; }));
  EXPECT_EQ(send_one(), frames_[1]);
  robot_->finish();  // tells the last of it
  ASSERT_TRUE(eventually([&] { return report() && report()->sent == 3; }));
  EXPECT_EQ(report()->level, 1U);
  EXPECT_EQ(report()->sweeps, 3U);
  EXPECT_EQ(report()->queued_frames, 0U);
  // Levels 1, 4, 1: 20, 5 after a fall of 15, 20 after a rise of 15.
  ASSERT_TRUE(report()->qoe);
  EXPECT_NEAR(*report()->qoe, (20.0 + 5.0 - 15.0 + 20.0 - 15.0) / 3.0, 1e-3);
}

TEST_F(Overridden, WithoutTheRightNothingIsAskedNorObeyed) {
  begin(false);
  EXPECT_FALSE(report()->can_override);
  const Status refused = server_->ask_level("rover", 4);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("rover"), std::string::npos);
  EXPECT_FALSE(server_->ask_level("mole", 4));
  EXPECT_EQ(send_one(), frames_[1]);
  const std::uint64_t reports = robot_->status().reports;
  ASSERT_TRUE(eventually([&] { return robot_->status().reports > reports + 2; }));
  EXPECT_EQ(send_one(), frames_[1]);
  EXPECT_FALSE(report()->override_level);
}

TEST_F(Overridden, AWishHoldsAcrossConnectionsAndLevelsAreChecked) {
  begin(true);
  EXPECT_FALSE(server_->ask_level("rover", 6));
  ASSERT_TRUE(server_->ask_level("rover", 5));
  ASSERT_TRUE(eventually([&] { return report() && report()->override_level == 5U; }));
  robot_.reset();
  ASSERT_TRUE(eventually([&] { return !report(); }));
  EXPECT_FALSE(server_->ask_level("rover", 2));  // it is not there
  SenderOptions options;
  options.port = server_->port();
  options.key = rover_;
  options.strategy = "fixed:1";
  options.allow_override = true;
  auto again = Sender::start(options);
  ASSERT_TRUE(again);
  EXPECT_TRUE(eventually([&] { return report() && report()->override_level == 5U; }));
  EXPECT_EQ(again->choose().level, 5U);
}

TEST_F(Live, OptionsAreChecked) {
  SenderOptions sender_options;
  EXPECT_FALSE(Sender::start(sender_options));  // no key
  sender_options.key = rover_;
  sender_options.deadline = 1ms;
  EXPECT_FALSE(Sender::start(sender_options));
  sender_options.deadline = 100ms;
  sender_options.strategy = "best";
  EXPECT_FALSE(Sender::start(sender_options));
  sender_options.strategy = "paper";
  sender_options.rate_hz = 0.0;
  EXPECT_FALSE(Sender::start(sender_options));
  EXPECT_FALSE(Receiver::start({}));
  Receiver server = receiver(0, {rover_});
  ReceiverOptions options;
  options.keys = {rover_};
  options.port = server.port();
  const auto taken = Receiver::start(options);
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().code, ErrorCode::io);
  Sender robot = sender(server.port(), rover_);
  EXPECT_FALSE(robot.send({small_frames(1).front(), "../x", "", steady_clock::now()}));
  EXPECT_FALSE(robot.send({bytes_of(100), "roof", "", steady_clock::now()}));
}

}  // namespace
}  // namespace sweepcast::test
