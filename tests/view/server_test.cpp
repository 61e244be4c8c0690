#include "view/server.hpp"

#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/bytes.hpp"
#include "view/recordings.hpp"
#include "view/web_client.hpp"

namespace sweepcast::test {
namespace {

using nlohmann::json;
using view::Server;

constexpr const char* kPage = "sweepcast.view.v1";

Server start(view::ServerOptions options, std::unique_ptr<view::Recording> recording) {
  auto server = Server::start(std::move(options), std::move(recording));
  if (!server) throw std::runtime_error(server.error().message);  // ends the test
  return std::move(*server);
}

/// The next text of this kind; others, and sweeps, are passed over. Null where the end comes first.
json next_of_kind(WebClient& client, const std::string& kind) {
  for (;;) {
    const Received got = client.read();
    if (!got.is_open) return nullptr;
    if (!got.is_text) continue;
    json text = json::parse(got.bytes, nullptr, false);
    if (text.is_object() && text["kind"] == kind) return text;
  }
}

struct SweepMessage {
  std::uint32_t index = 0;
  std::string name;
  std::vector<std::byte> frame;
};

/// The next sweep; none where the end comes first.
std::optional<SweepMessage> next_sweep(WebClient& client) {
  for (;;) {
    const Received got = client.read();
    if (!got.is_open) return std::nullopt;
    if (got.is_text) continue;
    const auto bytes = std::as_bytes(std::span(got.bytes));
    ByteReader in(bytes);
    EXPECT_EQ(in.get<std::uint32_t>(), 0x31565753U);
    (void)in.get<std::uint16_t>();
    const auto name_size = in.get<std::uint16_t>();
    SweepMessage sweep;
    sweep.index = in.get<std::uint32_t>();
    (void)in.get<std::uint64_t>();
    const auto name = in.get_bytes(name_size);
    sweep.name.assign(reinterpret_cast<const char*>(name.data()), name.size());
    const auto frame = in.get_bytes(in.remaining());
    sweep.frame.assign(frame.begin(), frame.end());
    EXPECT_TRUE(in.ok());
    return sweep;
  }
}

class ViewServer : public RecordingTest {};

TEST_F(ViewServer, AnswersOverHttp) {
  const Server server = start({}, open({write_original(1)}));
  EXPECT_EQ(server.url(), "http://127.0.0.1:" + std::to_string(server.port()));
  EXPECT_EQ(get_status(server.port(), "/healthz"), 200);
  EXPECT_EQ(get_status(server.port(), "/nothing"), 404);
  const std::string page =
      ask(server.port(), "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n");
  EXPECT_NE(page.find("Content-Security-Policy: default-src 'self'"), std::string::npos) << page;
  EXPECT_NE(page.find("Sweepcast"), std::string::npos);
  EXPECT_NE(ask(server.port(), "GET / HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n\r\n")
                .find("403"),
            std::string::npos);
  const std::string head =
      ask(server.port(), "HEAD /healthz HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n");
  EXPECT_NE(head.find("Content-Length: 3\r\n"), std::string::npos) << head;
  EXPECT_EQ(head.substr(head.size() - 4), "\r\n\r\n");
}

TEST_F(ViewServer, GivesOriginals) {
  const Server server = start({}, open({write_original(1)}));
  const std::string reply =
      ask(server.port(),
          "GET /original/1?stream=0 HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  EXPECT_NE(reply.find("X-Fields: x y z intensity\r\n"), std::string::npos);
  const std::string body = reply.substr(reply.find("\r\n\r\n") + 4);
  ASSERT_EQ(body.size(), clouds_[1].size() * 16);
  float value = 0;
  std::memcpy(&value, body.data() + 16 * 10 + 4, sizeof(value));
  EXPECT_EQ(value, clouds_[1].y[10]);
  for (const char* target : {"/original/0", "/original/1?stream=1", "/original/99", "/original/-1",
                             "/original/1x", "/original/"}) {
    EXPECT_EQ(get_status(server.port(), target), 404) << target;
  }
}

TEST_F(ViewServer, WantsATokenForAllButItsHealth) {
  const Server server = start({"127.0.0.1", 0, "s3cret", {}, {}, 10.0}, open());
  EXPECT_EQ(get_status(server.port(), "/healthz"), 200);
  EXPECT_EQ(get_status(server.port(), "/"), 401);
  EXPECT_EQ(get_status(server.port(), "/?token=wrong"), 401);
  EXPECT_EQ(get_status(server.port(), "/?token=s3cret"), 200);
  EXPECT_EQ(get_status(server.port(), "/", "Authorization: Bearer s3cret\r\n"), 200);
  EXPECT_EQ(get_status(server.port(), "/original/0"), 401);
  EXPECT_EQ(WebClient().connect(server.port(), "/live", kPage), 401);
  EXPECT_EQ(WebClient().connect(server.port(), "/live?token=s3cret", kPage), 101);
  EXPECT_EQ(WebClient().connect(server.port(), "/", "foxglove.websocket.v1"), 401);
}

TEST(ViewServerStart, NeedsATokenWhereOthersCanReachIt) {
  for (const char* address : {"0.0.0.0", "::", "192.168.1.1"}) {
    view::ServerOptions options;
    options.address = address;
    const auto refused = Server::start(options, nullptr);
    ASSERT_FALSE(refused) << address;
    EXPECT_EQ(refused.error().code, ErrorCode::invalid_argument);
    EXPECT_NE(refused.error().message.find("token"), std::string::npos);
  }
  view::ServerOptions open_to_all{"0.0.0.0", 0, "s3cret", {}, {}, 10.0};
  const auto server = Server::start(open_to_all, nullptr);
  ASSERT_TRUE(server) << server.error().message;
  EXPECT_EQ(get_status(server->port(), "/"), 401);
  EXPECT_FALSE(Server::start({"nowhere", 0, "", {}, {}, 10.0}, nullptr));
  EXPECT_FALSE(Server::start({"127.0.0.1", 0, "a b", {}, {}, 10.0}, nullptr));
  const auto taken = Server::start({"0.0.0.0", server->port(), "s", {}, {}, 10.0}, nullptr);
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().code, ErrorCode::io);
}

TEST_F(ViewServer, SweepsDecodeAsTheyDoNatively) {
  const Server server = start({}, open());
  WebClient client;
  ASSERT_EQ(client.connect(server.port(), "/live", kPage), 101);
  const json hello = next_of_kind(client, "hello");
  EXPECT_EQ(hello["source"], "file");
  EXPECT_EQ(hello["frames"], kFrames);
  client.send(R"({"kind":"pause"})");
  for (const std::uint32_t i : {3U, 0U, 4U}) {
    client.send(json{{"kind", "seek"}, {"index", i}}.dump());
    client.send(R"({"kind":"more","count":1})");
    const auto sweep = next_sweep(client);
    ASSERT_TRUE(sweep);
    EXPECT_EQ(sweep->index, i);
    EXPECT_EQ(sweep->name, "00000" + std::to_string(i));
    expect_same(decoded(sweep->frame), native_[i]);
  }
}

TEST_F(ViewServer, ClientsOfARecordingHavePlayersOfTheirOwn) {
  const Server server = start({}, open());
  WebClient one;
  WebClient other;
  ASSERT_EQ(one.connect(server.port(), "/live", kPage), 101);
  ASSERT_EQ(other.connect(server.port(), "/live", kPage), 101);
  one.send(R"({"kind":"pause"})");
  EXPECT_EQ(next_of_kind(one, "state")["playing"], true);
  EXPECT_EQ(next_of_kind(one, "state")["playing"], false);
  EXPECT_EQ(next_of_kind(other, "state")["playing"], true);
  other.send(R"({"kind":"more","count":2})");
  const auto first = next_sweep(other);
  const auto second = next_sweep(other);  // comes by the clock alone
  ASSERT_TRUE(first && second);
  EXPECT_NE(first->index, second->index);
}

TEST_F(ViewServer, EndsAClientThatTalksNonsenseAndNoOther) {
  const Server server = start({}, open());
  WebClient good;
  ASSERT_EQ(good.connect(server.port(), "/live", kPage), 101);
  for (const std::string& nonsense :
       {std::string("{"), std::string(R"({"kind":"dance"})"), std::string(1 << 20, ' ')}) {
    WebClient bad;
    ASSERT_EQ(bad.connect(server.port(), "/live", kPage), 101);
    bad.send(nonsense);
    EXPECT_EQ(next_of_kind(bad, "never"), nullptr) << nonsense.substr(0, 20);
  }
  EXPECT_EQ(get_status(server.port(), "/healthz"), 200);
  EXPECT_EQ(ask(server.port(), "GET / HTTP/1.1\r\nA: " + std::string(100'000, 'a')).find("200"),
            std::string::npos);
  EXPECT_EQ(WebClient().connect(server.port(), "/live", kPage, "https://evil.example"), 403);
  good.send(R"({"kind":"more","count":1})");
  EXPECT_TRUE(next_sweep(good));
}

TEST_F(ViewServer, TurnsAwayMoreConnectionsThanItHolds) {
  const Server server = start({}, open());
  std::vector<WebClient> crowd(64);
  for (WebClient& client : crowd) ASSERT_EQ(client.connect(server.port(), "/live", kPage), 101);
  EXPECT_EQ(get_status(server.port(), "/healthz"), 0);
  crowd.pop_back();
  while (get_status(server.port(), "/healthz") != 200) std::this_thread::yield();
  EXPECT_EQ(next_of_kind(crowd.front(), "hello")["version"], 1);
}

/// A frame that no compression makes small.
std::vector<std::byte> large_frame() {
  std::mt19937 random(1);
  PointCloud cloud;
  for (int i = 0; i < 60'000; ++i) {
    add_point(cloud, uniform(random, -50, 50), uniform(random, -50, 50), uniform(random, -5, 5));
  }
  EncoderOptions options;
  options.beam.lossless = true;
  options.beam.effort = Effort::fast;
  auto encoder = Encoder::create(options);
  const auto frame = encoder->encode(cloud, {});
  return {frame->begin(), frame->end()};
}

TEST(ViewServerLive, AStalledClientKeepsNobodyWaiting) {
  Server server = start({}, nullptr);
  const auto frame = large_frame();
  ASSERT_GT(frame.size(), 300'000U);
  std::vector<WebClient> clients(10);
  for (WebClient& client : clients) {
    ASSERT_EQ(client.connect(server.port(), "/live", kPage), 101);
    client.send(R"({"kind":"more","count":64})");
    ASSERT_EQ(next_of_kind(client, "hello")["source"], "live");
  }
  constexpr std::uint32_t kSweeps = 40;  // more bytes than sockets hold
  for (std::uint32_t i = 0; i < kSweeps; ++i) {
    server.publish({"rover", "roof", "a", frame, 0.1});
    for (std::size_t k = 1; k < clients.size(); ++k) {
      const auto sweep = next_sweep(clients[k]);
      ASSERT_TRUE(sweep);
      ASSERT_EQ(sweep->index, i) << "client " << k;
      ASSERT_EQ(sweep->frame, frame);
      clients[k].send(R"({"kind":"more","count":1})");
    }
  }
  // The stalled one finds what its socket held, and then the newest.
  std::uint32_t count = 0;
  for (std::uint32_t index = 0; index + 1 < kSweeps; ++count) {
    const auto sweep = next_sweep(clients.front());
    ASSERT_TRUE(sweep);
    index = sweep->index;
  }
  EXPECT_LT(count, kSweeps / 2);
}

TEST(ViewServerLive, TellsOfStreamsAndFigures) {
  Server server = start({}, nullptr);
  auto encoder = Encoder::create(beam_options(0.05));
  const PointCloud cloud = spinning_sweep(16, 360, 1);
  WebClient client;
  ASSERT_EQ(client.connect(server.port(), "/live", kPage), 101);
  EXPECT_EQ(next_of_kind(client, "hello")["streams"].size(), 0U);
  for (const std::uint64_t sequence : {0U, 1U, 4U}) {
    server.publish({"rover", "roof", "a", *encoder->encode(cloud, {sequence}), 0.05});
  }
  EXPECT_EQ(next_of_kind(client, "hello")["streams"][0]["sensor"], "roof");
  json robot;
  while (robot.is_null() || robot["sweeps"] != 3) {
    robot = next_of_kind(client, "status")["robots"].at(0);
  }
  EXPECT_EQ(robot["name"], "rover");
  EXPECT_EQ(robot["drops"], 2);
  EXPECT_NEAR(robot["age_ms"].get<double>(), 50.0, 1e-6);
  EXPECT_TRUE(robot["level"].is_null());
  client.send(R"({"kind":"more","count":1})");
  EXPECT_TRUE(next_sweep(client));
}

TEST(ViewServerLive, PassesWishesOnFromWhoMayViewForRobotsThatObey) {
  Server server = start({"127.0.0.1", 0, "s3cret", {}, {}, 10.0}, nullptr);
  auto encoder = Encoder::create(beam_options(0.05));
  server.publish({"rover", "roof", "a", *encoder->encode(spinning_sweep(16, 360, 1), {}), 0.05});
  EXPECT_EQ(WebClient().connect(server.port(), "/live", kPage), 401);
  WebClient client;
  ASSERT_EQ(client.connect(server.port(), "/live?token=s3cret", kPage), 101);
  client.send(R"({"kind":"override","robot":"rover","level":3})");
  EXPECT_EQ(next_of_kind(client, "notice")["level"], "warning");  // nobody said that it obeys
  EXPECT_TRUE(server.take_wishes().empty());
  SenderReport report;
  report.can_override = true;
  server.tell({{RobotStatus{"rover", true, report}}});
  json robot;
  while (robot.is_null() || !robot["can_override"].get<bool>()) {
    robot = next_of_kind(client, "status")["robots"].at(0);
  }
  client.send(R"({"kind":"override","robot":"rover","level":3})");
  client.send(R"({"kind":"override","robot":"rover","level":4})");
  client.send(R"({"kind":"override","robot":"mole","level":1})");
  EXPECT_EQ(next_of_kind(client, "notice")["level"], "warning");  // the mole's; all are taken
  const auto wishes = server.take_wishes();
  ASSERT_EQ(wishes.size(), 1U);
  EXPECT_EQ(wishes[0].robot, "rover");
  EXPECT_EQ(wishes[0].level, 4U);
  EXPECT_TRUE(server.take_wishes().empty());
}

}  // namespace
}  // namespace sweepcast::test
