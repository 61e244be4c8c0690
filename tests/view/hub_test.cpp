#include "view/hub.hpp"

#include <nlohmann/json.hpp>

#include "view/recordings.hpp"

namespace sweepcast::test {
namespace {

using namespace view;
using nlohmann::json;
using namespace std::chrono_literals;

class Viewer : public Attendee {
 public:
  Viewer(Hub& hub, Clock::time_point now) : client_(hub.make_client({true, {}}, now)) {
    hub.attend(*this);
  }
  [[nodiscard]] Client& client() override { return *client_; }
  void wake() override { ++woken; }
  void tick(Clock::time_point /*now*/) override {}

  /// All texts that wait, of the kinds that are not "hello".
  std::vector<json> texts(Clock::time_point now) {
    std::vector<json> all;
    while (const auto message = client_->next(now)) {
      if (!message->is_text) continue;
      const auto* begin = reinterpret_cast<const char*>(message->head.data());
      json text = json::parse(begin, begin + message->head.size());
      if (text["kind"] != "hello") all.push_back(std::move(text));
    }
    return all;
  }

  int woken = 0;

 private:
  std::unique_ptr<Client> client_;
};

class LiveHub : public ::testing::Test {
 protected:
  void SetUp() override {
    auto encoder = Encoder::create(beam_options(0.05));
    const auto frame = encoder->encode(spinning_sweep(16, 360, 1), {});
    ASSERT_TRUE(frame);
    frame_.assign(frame->begin(), frame->end());
  }
  void take(const std::string& sensor, Clock::time_point now) {
    hub_.take({"rover", sensor, "a", frame_, now}, now);
  }

  const Clock::time_point start_ = Clock::now();
  Bytes frame_;
  Hub hub_{Show{true, "live", 10.0, {}, false, {}}, nullptr, {}};
};

TEST_F(LiveHub, StreamsComeToBeWithTheirFirstSweep) {
  Viewer viewer(hub_, start_);
  take("roof", start_);
  take("side", start_);
  take("roof", start_);
  ASSERT_EQ(hub_.show().streams.size(), 2U);
  EXPECT_EQ(hub_.show().streams[1].id, 1);
  EXPECT_EQ(hub_.show().streams[1].sensor, "side");
  EXPECT_EQ(viewer.woken, 3);
  hub_.leave(viewer);
  take("roof", start_);
  EXPECT_EQ(viewer.woken, 3);
}

TEST_F(LiveHub, TellsOnceThatAStreamStoppedAndThatItGoesOn) {
  Viewer viewer(hub_, start_);
  take("roof", start_);
  hub_.tell_status({}, start_ + 1s);
  EXPECT_EQ(viewer.texts(start_).size(), 1U);  // the status
  for (const auto after : {3s, 4s}) hub_.tell_status({}, start_ + after);
  auto texts = viewer.texts(start_);
  ASSERT_EQ(texts.size(), 2U);
  EXPECT_EQ(texts[0]["level"], "warning");
  EXPECT_EQ(texts[0]["text"].get<std::string>().substr(0, 11), "rover/roof:");
  Viewer late(hub_, start_ + 5s);
  EXPECT_EQ(late.texts(start_ + 5s).at(0)["level"], "warning");
  take("roof", start_ + 6s);
  texts = viewer.texts(start_ + 6s);
  ASSERT_EQ(texts.size(), 1U);
  EXPECT_EQ(texts[0]["level"], "info");
}

TEST_F(LiveHub, WhoComesLateSeesTheLastSweep) {
  take("roof", start_);
  Viewer late(hub_, start_);
  ASSERT_TRUE(late.client().take(R"({"kind":"more","count":1})", true, start_));
  EXPECT_TRUE(late.client().next(start_)->is_text);
  const auto message = late.client().next(start_);
  ASSERT_TRUE(message && !message->is_text);
  EXPECT_EQ(*message->body, frame_);
}

TEST_F(LiveHub, TakesNoMoreStreamsThanHaveAnIdAndNoFrameThatIsNone) {
  hub_.take({"rover", "roof", "a", Bytes(100), start_}, start_);
  EXPECT_TRUE(hub_.show().streams.empty());
  for (int i = 0; i < 300; ++i) take(std::to_string(i), start_);
  EXPECT_EQ(hub_.show().streams.size(), kMostStreams);
}

TEST(Figures, HaveWhatSendersTellWhileTheyAreConnected) {
  const Clock::time_point start{1000s};
  Figures figures;
  figures.add("rover", "roof", 0, 1000, 0.05, start);
  figures.add("mole", "roof", 0, 1000, 0.05, start);
  SenderReport report;
  report.level = 2;
  report.queued_frames = 3;
  report.queued_bytes = 40'000;
  report.dropped = 5;
  report.can_override = true;
  RobotStatus rover{"rover", true, report};
  figures.tell({{rover, {"mole", true, std::nullopt}, {"ghost", true, report}}});
  auto robots = figures.robots(start);
  ASSERT_EQ(robots.size(), 2U);
  const json status = json::parse(write_status(1.0, robots))["robots"];
  EXPECT_EQ(status[0]["name"], "mole");
  for (const char* key :
       {"level", "queue_frames", "queue_bytes", "sender_drops", "qoe", "override"}) {
    EXPECT_TRUE(status[0].at(key).is_null()) << key;
  }
  EXPECT_EQ(status[0]["can_override"], false);
  EXPECT_EQ(status[1]["level"], 2);
  EXPECT_EQ(status[1]["queue_frames"], 3);
  EXPECT_EQ(status[1]["queue_bytes"], 40'000);
  EXPECT_EQ(status[1]["sender_drops"], 5);
  EXPECT_TRUE(status[1]["qoe"].is_null());
  EXPECT_TRUE(status[1]["override"].is_null());
  EXPECT_EQ(status[1]["can_override"], true);
  EXPECT_TRUE(figures.obeys("rover"));
  EXPECT_FALSE(figures.obeys("mole"));
  EXPECT_FALSE(figures.obeys("nobody"));
  rover.connected = false;
  figures.tell({{rover}});
  EXPECT_FALSE(figures.obeys("rover"));
  EXPECT_FALSE(figures.robots(start)[1].sender);
}

TEST(Figures, AreOfTheLastTwoSeconds) {
  const Clock::time_point start{1000s};
  Figures figures;
  EXPECT_TRUE(figures.robots(start).empty());
  std::uint64_t sequence = 0;
  for (int i = 0; i < 50; ++i) {  // 10 a second; every tenth is missing
    if (i % 10 != 9) figures.add("rover", "roof", sequence, 1000, 0.05, start + i * 100ms);
    ++sequence;
  }
  figures.add("other", "roof", 7, 10, 0.1, start);
  const auto robots = figures.robots(start + 4900ms);
  ASSERT_EQ(robots.size(), 2U);
  EXPECT_FALSE(robots[0].connected);
  EXPECT_FALSE(robots[0].bytes_per_sweep);
  const RobotFigures& rover = robots[1];
  EXPECT_TRUE(rover.connected);
  EXPECT_EQ(rover.sweeps, 45U);
  EXPECT_EQ(rover.drops, 4U);
  EXPECT_EQ(rover.bytes_per_sweep, 1000.0);
  EXPECT_NEAR(rover.bytes_per_second, 9000.0, 600.0);
  EXPECT_NEAR(rover.age_ms, 50.0, 1e-9);
  figures.add("rover", "roof", 0, 1000, 0.05, start + 5s);  // it began anew
  EXPECT_EQ(figures.robots(start + 5s)[1].drops, 4U);
}

}  // namespace
}  // namespace sweepcast::test
