#include "view/page_client.hpp"

#include <nlohmann/json.hpp>

#include "core/bytes.hpp"
#include "view/recordings.hpp"

namespace sweepcast::test {
namespace {

using namespace view;
using nlohmann::json;
using namespace std::chrono_literals;

const Clock::time_point kStart{1000s};

std::string text_of(const Message& message) {
  return {reinterpret_cast<const char*>(message.head.data()), message.head.size()};
}

/// The next text as JSON; "discarded" where there is none.
json next_json(Client& client, Clock::time_point now = kStart) {
  const auto message = client.next(now);
  if (!message || !message->is_text) return json::parse("", nullptr, false);
  return json::parse(text_of(*message), nullptr, false);
}

void send(Client& client, const std::string& text, Clock::time_point now = kStart) {
  const Status taken = client.take(text, true, now);
  EXPECT_TRUE(taken) << text << taken.error().message;
}

std::uint32_t index_of(const Message& message) {
  return ByteReader(std::span(message.head).subspan(8)).get<std::uint32_t>();
}

SharedSweep live_sweep(std::uint8_t stream, std::uint32_t index) {
  auto sweep = std::make_shared<Sweep>();
  sweep->stream = stream;
  sweep->index = index;
  sweep->name = "s";
  sweep->layers = {3, 5};
  sweep->captured = kStart - 250ms;
  sweep->frame = std::make_shared<const Bytes>(7);
  return sweep;
}

class LivePage : public ::testing::Test {
 protected:
  Show show_{true, "live", 10.0, {}, false, {{0, "rover", "roof"}}};
  PageClient client_{show_, nullptr, kStart};
};

TEST_F(LivePage, BeginsWithAHello) {
  const json hello = next_json(client_);
  EXPECT_EQ(hello["kind"], "hello");
  EXPECT_EQ(hello["version"], 1);
  EXPECT_EQ(hello["source"], "live");
  EXPECT_TRUE(hello["frames"].is_null());
  EXPECT_EQ(hello["streams"], json::parse(R"([{"id":0,"robot":"rover","sensor":"roof"}])"));
  EXPECT_FALSE(client_.next(kStart));
  client_.streams_changed();
  EXPECT_EQ(next_json(client_)["kind"], "hello");
}

TEST_F(LivePage, GetsNothingWithoutCreditAndThenTheNewest) {
  (void)client_.next(kStart);
  for (std::uint32_t i = 0; i < 1000; ++i) client_.offer(live_sweep(0, i));
  client_.offer(live_sweep(1, 5));
  EXPECT_FALSE(client_.next(kStart));
  send(client_, R"({"kind":"more","count":1})");
  const auto first = client_.next(kStart);
  ASSERT_TRUE(first && !first->is_text);
  EXPECT_EQ(index_of(*first), 999U);
  EXPECT_FALSE(client_.next(kStart));  // the credit is used up
  send(client_, R"({"kind":"more","count":4000000000})");
  const auto second = client_.next(kStart);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->head[4], std::byte{1});  // the other stream's
  EXPECT_FALSE(client_.next(kStart));
}

TEST_F(LivePage, HeadsASweepAsTheProtocolSays) {
  (void)client_.next(kStart);
  client_.offer(live_sweep(0, 0x01020304));
  send(client_, R"({"kind":"more","count":1})");
  const auto message = client_.next(kStart);
  ASSERT_TRUE(message);
  std::vector<unsigned> got;
  for (const std::byte b : message->head) got.push_back(std::to_integer<unsigned>(b));
  const std::vector<unsigned> expected{'S', 'W', 'V', '1', 0, 0, 1, 0, 4, 3,  2,
                                       1,   250, 0,   0,   0, 3, 0, 5, 0, 's'};
  EXPECT_EQ(got, expected);
  EXPECT_EQ(message->body->size(), 7U);
}

TEST_F(LivePage, KeepsAFewNoticesAndTheNewestStatus) {
  (void)client_.next(kStart);
  for (int i = 0; i < 1000; ++i) {
    client_.notify(NoticeLevel::warning, std::to_string(i));
    client_.tell_status(R"({"kind":"status","i":)" + std::to_string(i) + "}");
  }
  std::vector<json> texts;
  for (json text = next_json(client_); !text.is_discarded(); text = next_json(client_)) {
    texts.push_back(text);
  }
  ASSERT_EQ(texts.size(), 17U);
  EXPECT_EQ(texts[15]["text"], "999");
  EXPECT_EQ(texts[15]["level"], "warning");
  EXPECT_EQ(texts[16]["i"], 999);
}

TEST_F(LivePage, SaysWhatCannotBe) {
  (void)client_.next(kStart);
  send(client_, R"({"kind":"override","robot":"rover","level":3})");
  send(client_, R"({"kind":"pause"})");
  EXPECT_EQ(next_json(client_)["level"], "warning");
  EXPECT_EQ(next_json(client_)["kind"], "notice");
  EXPECT_FALSE(client_.next(kStart));
}

TEST_F(LivePage, AsksForLevelsWhereTheRobotObeys) {
  std::vector<std::pair<std::string, std::optional<std::size_t>>> asked;
  PageClient client(show_, nullptr, kStart, [&](const std::string& robot, auto level) {
    asked.emplace_back(robot, level);
    return robot == "rover";
  });
  (void)client.next(kStart);
  send(client, R"({"kind":"override","robot":"rover","level":5})");
  send(client, R"({"kind":"override","robot":"rover","level":null})");
  EXPECT_FALSE(client.next(kStart));  // the next status tells what came of it
  send(client, R"({"kind":"override","robot":"mole","level":0})");
  const json notice = next_json(client);
  EXPECT_EQ(notice["level"], "warning");
  EXPECT_NE(notice["text"].get<std::string>().find("mole"), std::string::npos);
  ASSERT_EQ(asked.size(), 3U);
  EXPECT_EQ(asked[0].second, 5U);
  EXPECT_FALSE(asked[1].second);
  for (const char* text : {R"({"kind":"override"})", R"({"kind":"override","robot":"rover"})",
                           R"({"kind":"override","robot":7,"level":1})",
                           R"({"kind":"override","robot":"rover","level":6})",
                           R"({"kind":"override","robot":"rover","level":-1})",
                           R"({"kind":"override","robot":"rover","level":"1"})",
                           R"({"kind":"override","robot":"rover","level":1.5})"}) {
    EXPECT_FALSE(client.take(text, true, kStart)) << text;
  }
  EXPECT_EQ(asked.size(), 3U);
}

TEST_F(LivePage, RefusesWhatIsNoMessage) {
  for (const char* text :
       {"", "{", "[]", "null", "{}", R"({"kind":7})", R"({"kind":"dance"})", R"({"kind":"more"})",
        R"({"kind":"more","count":-1})", R"({"kind":"more","count":1.5})",
        R"({"kind":"seek","index":4294967296})", R"({"kind":"speed","value":"x"})",
        R"({"kind":"loop","value":1})", "{\"kind\":\"more\",\"count\":1}x", "\xff\xfe"}) {
    EXPECT_FALSE(client_.take(text, true, kStart)) << text;
  }
  EXPECT_FALSE(client_.take(R"({"kind":"play"})", false, kStart));
}

class RecordingPage : public RecordingTest {
 protected:
  void begin() {
    recording_ = open();
    client_.emplace(show_, recording_.get(), kStart);
    EXPECT_EQ(next_json(*client_)["kind"], "hello");
    const json state = next_json(*client_);
    EXPECT_EQ(state["kind"], "state");
    EXPECT_EQ(state["playing"], true);
  }

  Show show_{false, "roof", 10.0, kFrames, false, {{0, "rover", "roof"}}};
  std::unique_ptr<Recording> recording_;
  std::optional<PageClient> client_;
};

TEST_F(RecordingPage, PlaysByTheClockAndSkipsWhatHadNoCredit) {
  begin();
  EXPECT_FALSE(client_->next(kStart));
  send(*client_, R"({"kind":"more","count":2})");
  const auto first = client_->next(kStart);
  ASSERT_TRUE(first);
  EXPECT_EQ(index_of(*first), 0U);
  EXPECT_FALSE(client_->next(kStart + 50ms));
  const auto due = client_->due(kStart + 50ms);
  ASSERT_TRUE(due);
  EXPECT_NEAR(std::chrono::duration<double>(*due - kStart).count(), 0.1, 0.001);
  const auto second = client_->next(kStart + 310ms);
  ASSERT_TRUE(second);
  EXPECT_EQ(index_of(*second), 3U);
  EXPECT_FALSE(client_->next(kStart + 450ms));
  send(*client_, R"({"kind":"more","count":1})", kStart + 620ms);
  const auto third = client_->next(kStart + 620ms);  // the second round
  ASSERT_TRUE(third);
  EXPECT_EQ(index_of(*third), 1U);
}

TEST_F(RecordingPage, PausesSeeksAndChangesSpeed) {
  begin();
  send(*client_, R"({"kind":"more","count":9})");
  send(*client_, R"({"kind":"pause"})");
  EXPECT_EQ(next_json(*client_)["playing"], false);
  EXPECT_EQ(index_of(*client_->next(kStart)), 0U);
  EXPECT_FALSE(client_->next(kStart + 10s));
  EXPECT_FALSE(client_->due(kStart + 10s));
  send(*client_, R"({"kind":"seek","index":3})", kStart + 10s);
  EXPECT_EQ(next_json(*client_, kStart + 10s)["index"], 3);
  EXPECT_EQ(index_of(*client_->next(kStart + 10s)), 3U);
  send(*client_, R"({"kind":"seek","index":77})", kStart + 10s);
  EXPECT_EQ(next_json(*client_, kStart + 10s)["index"], 4);
  EXPECT_EQ(index_of(*client_->next(kStart + 10s)), 4U);
  send(*client_, R"({"kind":"seek","index":0})", kStart + 10s);
  send(*client_, R"({"kind":"speed","value":0.5})", kStart + 10s);
  send(*client_, R"({"kind":"play"})", kStart + 10s);
  const json state = next_json(*client_, kStart + 10s);
  EXPECT_EQ(state["playing"], true);
  EXPECT_EQ(state["speed"], 0.5);
  EXPECT_EQ(index_of(*client_->next(kStart + 10s + 401ms)), 2U);
}

TEST_F(RecordingPage, StopsAtTheEndWhereNothingIsRepeated) {
  begin();
  send(*client_, R"({"kind":"loop","value":false})");
  EXPECT_EQ(next_json(*client_)["loop"], false);
  send(*client_, R"({"kind":"more","count":9})", kStart + 5s);
  EXPECT_EQ(index_of(*client_->next(kStart + 5s)), 4U);
  const json state = next_json(*client_, kStart + 5s);
  EXPECT_EQ(state["playing"], false);
  EXPECT_EQ(state["index"], 4);
  send(*client_, R"({"kind":"play"})", kStart + 6s);
  EXPECT_EQ(next_json(*client_, kStart + 6s)["playing"], true);
  EXPECT_EQ(index_of(*client_->next(kStart + 6s)), 0U);
}

TEST_F(RecordingPage, TellsOfADamagedFrameOnceAndGoesOn) {
  damage(1);
  begin();
  send(*client_, R"({"kind":"more","count":9})");
  EXPECT_EQ(index_of(*client_->next(kStart)), 0U);
  const json notice = next_json(*client_, kStart + 110ms);
  EXPECT_EQ(notice["level"], "error");
  EXPECT_NE(notice["text"].get<std::string>().find("frame 1"), std::string::npos);
  EXPECT_FALSE(client_->next(kStart + 120ms));
  EXPECT_EQ(index_of(*client_->next(kStart + 210ms)), 2U);
}

}  // namespace
}  // namespace sweepcast::test
