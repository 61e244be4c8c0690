#include "view/foxglove_client.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/bytes.hpp"
#include "view/foxglove.hpp"

namespace sweepcast::view {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostTexts = 16;
constexpr std::size_t kMostKeptClouds = 8;
constexpr std::uint8_t kMessageData = 1;

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::int64_t wall_clock_ns() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

Json channel_of(const Stream& stream) {
  static const std::string schema = base64(point_cloud_descriptors());
  return {{"id", stream.id},        {"topic", "/" + stream.robot + "/" + stream.sensor + "/points"},
          {"encoding", "protobuf"}, {"schemaName", kPointCloudSchema},
          {"schema", schema},       {"schemaEncoding", "protobuf"}};
}

/// A whole number of 32 bits; none for anything else.
std::optional<std::uint32_t> number_of(const Json& value) {
  if (!value.is_number_unsigned()) return std::nullopt;
  const auto number = value.get<std::uint64_t>();
  if (number > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return static_cast<std::uint32_t>(number);
}

std::optional<std::uint32_t> number_of(const Json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return found == object.end() ? std::nullopt : number_of(*found);
}

}  // namespace

Result<SharedBytes> FoxgloveClouds::message_of(const SharedSweep& sweep, const Show& show) {
  for (const auto& [kept, bytes] : kept_) {
    if (kept == sweep) return bytes;
  }
  if (Status decoded = decoder_.decode(*sweep->frame, cloud_); !decoded) {
    return tl::unexpected(decoded.error());
  }
  const std::int64_t stamp_ns = decoder_.last_header().stamp_ns;
  const Stream& stream = show.streams[sweep->stream];
  auto made = std::make_shared<const Bytes>(
      point_cloud_message(cloud_, stamp_ns == 0 ? wall_clock_ns() : stamp_ns, stream.sensor));
  if (kept_.size() == kMostKeptClouds) kept_.pop_front();
  kept_.emplace_back(sweep, made);
  return SharedBytes(made);
}

FoxgloveClient::FoxgloveClient(const Show& show, Recording* recording, FoxgloveClouds& clouds,
                               Clock::time_point now)
    : show_(show), recording_(recording), clouds_(clouds) {
  if (recording != nullptr) player_.emplace(recording->size(), show.rate_hz, now);
}

Status FoxgloveClient::take(std::string_view message, bool is_text, Clock::time_point /*now*/) {
  if (!is_text) return {};  // what clients publish and call is not for us
  const Json json = Json::parse(message, nullptr, false);
  const auto named = json.is_object() ? json.find("op") : json.end();
  if (!json.is_object() || named == json.end() || !named->is_string()) {
    return fail(ErrorCode::invalid_argument, "a message is no JSON object with an \"op\"");
  }
  const auto list = [&](const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_array() ? *found : Json::array();
  };
  const auto op = named->get<std::string>();
  if (op == "subscribe") {
    for (const Json& wanted : list("subscriptions")) {
      const auto id = number_of(wanted, "id");
      const auto channel = number_of(wanted, "channelId");
      if (!id || !channel || *channel >= show_.streams.size()) {
        notify(NoticeLevel::warning, "a subscription to a channel that there is not");
      } else if (subscriptions_.size() < kMostSubscriptions || subscriptions_.contains(*id)) {
        subscriptions_[*id] = *channel;
        shown_.reset();
      } else {
        notify(NoticeLevel::warning, "too many subscriptions");
      }
    }
  } else if (op == "unsubscribe") {
    for (const Json& wanted : list("subscriptionIds")) {
      if (const auto id = number_of(wanted)) subscriptions_.erase(*id);
    }
  } else {
    notify(NoticeLevel::warning, "this server knows \"subscribe\" and \"unsubscribe\" alone");
  }
  return {};
}

void FoxgloveClient::notify(NoticeLevel level, const std::string& text) {
  if (texts_.size() == kMostTexts) texts_.pop_front();
  texts_.push_back(
      text_of({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", text}}));
}

void FoxgloveClient::offer(const SharedSweep& sweep) {
  const bool is_wanted =
      std::any_of(subscriptions_.begin(), subscriptions_.end(),
                  [&](const auto& entry) { return entry.second == sweep->stream; });
  if (is_wanted) waiting_.add(sweep);
}

std::optional<Message> FoxgloveClient::next_text() {
  if (std::exchange(info_due_, false)) {
    return text_message(text_of({{"op", "serverInfo"},
                                 {"name", "sweepcast: " + show_.title},
                                 {"capabilities", Json::array()},
                                 {"supportedEncodings", Json::array()},
                                 {"metadata", Json::object()}}));
  }
  if (advertised_ < show_.streams.size()) {
    Json channels = Json::array();
    for (; advertised_ < show_.streams.size(); ++advertised_) {
      channels.push_back(channel_of(show_.streams[advertised_]));
    }
    return text_message(text_of({{"op", "advertise"}, {"channels", std::move(channels)}}));
  }
  if (texts_.empty()) return std::nullopt;
  Message message = text_message(texts_.front());
  texts_.pop_front();
  return message;
}

/// The cloud at hand, to the next of its subscribers that is still there.
std::optional<Message> FoxgloveClient::next_message() {
  while (!subscribers_.empty()) {
    const std::uint32_t id = subscribers_.front();
    subscribers_.pop_front();
    if (!subscriptions_.contains(id)) continue;
    Message message{false, {}, cloud_};
    ByteWriter head(message.head);
    head.put(kMessageData);
    head.put(id);
    head.put(wall_clock_ns());
    return message;
  }
  cloud_.reset();
  return std::nullopt;
}

SharedSweep FoxgloveClient::next_sweep(Clock::time_point now) {
  if (!player_) return waiting_.empty() ? nullptr : waiting_.take();
  const std::uint32_t index = player_->index(now);
  const std::uint32_t channel = recording_->stream_of(index);
  const bool is_wanted = std::any_of(subscriptions_.begin(), subscriptions_.end(),
                                     [&](const auto& entry) { return entry.second == channel; });
  if (!is_wanted || shown_ == index) return nullptr;
  shown_ = index;
  auto sweep = recording_->sweep(index);
  if (sweep) return *sweep;
  notify(NoticeLevel::error, sweep.error().message);
  return nullptr;
}

std::optional<Message> FoxgloveClient::next(Clock::time_point now) {
  if (auto text = next_text()) return text;
  if (auto message = next_message()) return message;
  const SharedSweep sweep = next_sweep(now);
  if (!sweep) return next_text();
  auto cloud = clouds_.message_of(sweep, show_);
  if (!cloud) {
    notify(NoticeLevel::error, sweep->name + ": " + cloud.error().message);
    return next_text();
  }
  cloud_ = *cloud;
  for (const auto& [id, channel] : subscriptions_) {
    if (channel == sweep->stream) subscribers_.push_back(id);
  }
  return next_message();
}

std::optional<Clock::time_point> FoxgloveClient::due(Clock::time_point now) {
  return player_ && !subscriptions_.empty() ? player_->next_change(now) : std::nullopt;
}

}  // namespace sweepcast::view
