#include "view/foxglove.hpp"

#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "core/bytes.hpp"
#include "view/foxglove_client.hpp"
#include "view/recordings.hpp"

namespace sweepcast::test {
namespace {

using namespace view;
using nlohmann::json;
using namespace std::chrono_literals;

const Clock::time_point kStart{1000s};

std::string base64_of(std::string_view text) {
  return base64(std::as_bytes(std::span(text)));
}

/// The fields of a Protocol Buffers message: numbers as 8 bytes, the rest as they are.
std::multimap<std::uint64_t, Bytes> fields_of(std::span<const std::byte> bytes) {
  std::multimap<std::uint64_t, Bytes> fields;
  ByteReader in(bytes);
  while (in.ok() && !in.at_end()) {
    const std::uint64_t tag = in.get_varint();
    Bytes value;
    ByteWriter out(value);
    if ((tag & 7) == 0) out.put(in.get_varint());
    if ((tag & 7) == 1) out.put(in.get<std::uint64_t>());
    if ((tag & 7) == 5) out.put(std::uint64_t{in.get<std::uint32_t>()});
    if ((tag & 7) == 2) out.put_bytes(in.get_bytes(in.get_varint()));
    fields.emplace(tag >> 3, value);
  }
  EXPECT_TRUE(in.ok());
  return fields;
}

std::string text_of(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::uint64_t number_of(const Bytes& bytes) {
  return ByteReader(bytes).get<std::uint64_t>();
}

float float_at(std::span<const std::byte> bytes, std::size_t at) {
  float value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

/// The examples of RFC 4648.
TEST(Foxglove, Base64) {
  EXPECT_EQ(base64_of(""), "");
  EXPECT_EQ(base64_of("f"), "Zg==");
  EXPECT_EQ(base64_of("fo"), "Zm8=");
  EXPECT_EQ(base64_of("foo"), "Zm9v");
  EXPECT_EQ(base64_of("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64_of("\xff\xfe\xfd"), "//79");
}

TEST(Foxglove, APointCloudIsThereFieldByField) {
  PointCloud cloud;
  cloud.x = {1, std::numeric_limits<float>::quiet_NaN(), -2.5F};
  cloud.y = {3, 0, 4};
  cloud.z = {5, 0, 6};
  cloud.intensity = {0.25F, 0, 0.75F};
  cloud.ring = {7, 0, 300};
  const auto message = fields_of(point_cloud_message(cloud, -1'500'000'000, "roof"));
  const auto stamp = fields_of(message.find(1)->second);
  EXPECT_EQ(number_of(stamp.find(1)->second), static_cast<std::uint64_t>(-2));
  EXPECT_EQ(number_of(stamp.find(2)->second), 500'000'000U);
  EXPECT_EQ(text_of(message.find(2)->second), "roof");
  EXPECT_EQ(number_of(message.find(4)->second), 18U);
  ASSERT_EQ(message.count(5), 5U);
  std::vector<std::string> names;
  for (auto [at, end] = message.equal_range(5); at != end; ++at) {
    names.push_back(text_of(fields_of(at->second).find(1)->second));
  }
  EXPECT_EQ(names, (std::vector<std::string>{"x", "y", "z", "intensity", "ring"}));
  const Bytes data = message.find(6)->second;
  ASSERT_EQ(data.size(), 36U);
  EXPECT_EQ(float_at(data, 18), -2.5F);
  EXPECT_EQ(float_at(data, 12), 0.25F);
  EXPECT_EQ(ByteReader(std::span(data).subspan(34)).get<std::uint16_t>(), 300);
}

TEST(Foxglove, TheSchemaHoldsWhatItRefersTo) {
  const auto files = fields_of(point_cloud_descriptors());
  ASSERT_EQ(files.count(1), 6U);
  std::vector<std::string> named;
  for (const auto& [number, bytes] : files) {
    const auto file = fields_of(bytes);
    for (auto [at, end] = file.equal_range(3); at != end; ++at) {
      EXPECT_NE(std::find(named.begin(), named.end(), text_of(at->second)), named.end())
          << text_of(at->second) << " is imported before it is there";
    }
    named.push_back(text_of(file.find(1)->second));
  }
  EXPECT_EQ(named.back(), "foxglove/PointCloud.proto");
}

class FoxgloveSession : public RecordingTest {
 protected:
  void SetUp() override {
    RecordingTest::SetUp();
    recording_ = open();
    client_.emplace(show_, recording_.get(), clouds_, kStart);
  }
  json next_json(Clock::time_point now = kStart) {
    const auto message = client_->next(now);
    if (!message || !message->is_text) return json::parse("", nullptr, false);
    return json::parse(text_of(message->head), nullptr, false);
  }
  void send(const std::string& text) { EXPECT_TRUE(client_->take(text, true, kStart)) << text; }

  Show show_{false, "roof", 10.0, kFrames, false, {{0, "rover", "roof"}}};
  std::unique_ptr<Recording> recording_;
  FoxgloveClouds clouds_;
  std::optional<FoxgloveClient> client_;
};

TEST_F(FoxgloveSession, AdvertisesAndSendsWhatIsSubscribed) {
  EXPECT_EQ(next_json()["op"], "serverInfo");
  const json advertise = next_json();
  EXPECT_EQ(advertise["op"], "advertise");
  const json& channel = advertise["channels"][0];
  EXPECT_EQ(channel["topic"], "/rover/roof/points");
  EXPECT_EQ(channel["encoding"], "protobuf");
  EXPECT_EQ(channel["schemaName"], "foxglove.PointCloud");
  EXPECT_EQ(channel["schema"], base64(point_cloud_descriptors()));
  EXPECT_FALSE(client_->next(kStart + 1s));  // nobody subscribed
  send(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":0},{"id":9,"channelId":0}]})");
  for (const std::uint32_t id : {7U, 9U}) {
    const auto message = client_->next(kStart + 1210ms);
    ASSERT_TRUE(message && !message->is_text);
    ByteReader head(message->head);
    EXPECT_EQ(head.get<std::uint8_t>(), 1);
    EXPECT_EQ(head.get<std::uint32_t>(), id);
    EXPECT_GT(head.get<std::uint64_t>(), 1'600'000'000'000'000'000U);
    EXPECT_TRUE(head.at_end());
    const auto cloud = fields_of(*message->body);
    EXPECT_EQ(text_of(cloud.find(2)->second), "roof");
    const Bytes& data = cloud.find(6)->second;
    ASSERT_EQ(data.size(), native_[2].size() * 16);
    EXPECT_EQ(float_at(data, data.size() - 16), native_[2].x.back());
  }
  EXPECT_FALSE(client_->next(kStart + 1220ms));
  send(R"({"op":"unsubscribe","subscriptionIds":[7,9]})");
  EXPECT_FALSE(client_->next(kStart + 1410ms));
  EXPECT_FALSE(client_->due(kStart + 1410ms));
}

TEST_F(FoxgloveSession, BearsWhateverComes) {
  (void)next_json();
  (void)next_json();
  send(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":5},{"id":-1},7,null]})");
  send(R"({"op":"subscribe"})");
  send(R"({"op":"unsubscribe","subscriptionIds":{"a":1}})");
  EXPECT_EQ(next_json()["op"], "status");
  for (int i = 0; i < 1000; ++i) send(R"({"op":"getParameters","parameterNames":[]})");
  std::size_t texts = 0;
  while (!next_json().is_discarded()) ++texts;
  EXPECT_EQ(texts, 16U);
  EXPECT_TRUE(client_->take("\x01\x02", false, kStart));
  EXPECT_FALSE(client_->take("{}", true, kStart));
  EXPECT_FALSE(client_->take("[", true, kStart));
  EXPECT_FALSE(client_->next(kStart + 1s));
}

}  // namespace
}  // namespace sweepcast::test
