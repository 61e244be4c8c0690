#include "view/protocol.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/bytes.hpp"
#include "rate/qoe.hpp"

namespace sweepcast::view {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kSweepMagic = 0x31565753;  // "SWV1"
constexpr std::uint8_t kHasOriginal = 1;
constexpr std::size_t kMostName = 0xFFFF;

/// Bytes that are not UTF-8, as a file's name may have, become U+FFFD.
std::string text_in(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

tl::unexpected<Error> refuse(const std::string& what) {
  return fail(ErrorCode::invalid_argument, what + "; docs/view.md has the messages");
}

/// A whole number from 0 to 2^32 - 1.
Result<std::uint32_t> number_in(const Json& message, const char* key) {
  const auto found = message.find(key);
  if (found != message.end() && found->is_number_unsigned()) {
    const auto value = found->get<std::uint64_t>();
    if (value <= std::numeric_limits<std::uint32_t>::max()) {
      return static_cast<std::uint32_t>(value);
    }
  }
  return refuse("a message's \"" + std::string(key) + "\" is no whole number of 32 bits");
}

Result<Command> read_override(const Json& message) {
  const auto robot = message.find("robot");
  if (robot == message.end() || !robot->is_string()) return refuse("\"override\" has no robot");
  Command command{Command::Kind::override_level};
  command.robot = robot->get<std::string>();
  const auto level = message.find("level");
  if (level == message.end()) return refuse("\"override\" has no level");
  if (level->is_null()) return command;
  const auto number = number_in(message, "level");
  if (!number) return tl::unexpected(number.error());
  if (*number >= kLevels) return refuse("\"override\" has a level beyond 5");
  command.level = *number;
  return command;
}

}  // namespace

std::string write_hello(const Show& show) {
  Json streams = Json::array();
  for (const Stream& stream : show.streams) {
    streams.push_back({{"id", stream.id}, {"robot", stream.robot}, {"sensor", stream.sensor}});
  }
  return text_in({{"kind", "hello"},
                  {"version", 1},
                  {"source", show.is_live ? "live" : "file"},
                  {"title", show.title},
                  {"rate_hz", show.rate_hz},
                  {"frames", or_null(show.frames)},
                  {"has_original", show.has_original},
                  {"streams", std::move(streams)}});
}

std::string write_status(double time_s, std::span<const RobotFigures> robots) {
  Json list = Json::array();
  for (const RobotFigures& robot : robots) {
    // What nobody tells stays null.
    const auto told = [&](auto SenderReport::*figure) {
      return robot.sender ? Json((*robot.sender).*figure) : Json(nullptr);
    };
    const SenderReport sender = robot.sender.value_or(SenderReport{});
    list.push_back({{"name", robot.name},
                    {"connected", robot.connected},
                    {"bytes_per_second", robot.bytes_per_second},
                    {"bytes_per_sweep", or_null(robot.bytes_per_sweep)},
                    {"level", or_null(sender.level)},
                    {"queue_frames", told(&SenderReport::queued_frames)},
                    {"queue_bytes", told(&SenderReport::queued_bytes)},
                    {"age_ms", robot.age_ms},
                    {"drops", robot.drops},
                    {"sender_drops", told(&SenderReport::dropped)},
                    {"qoe", or_null(sender.qoe)},
                    {"sweeps", robot.sweeps},
                    {"can_override", sender.can_override},
                    {"override", or_null(sender.override_level)}});
  }
  return text_in({{"kind", "status"}, {"time_s", time_s}, {"robots", std::move(list)}});
}

std::string write_state(Player& player, Clock::time_point now) {
  const std::uint32_t index = player.index(now);
  return text_in({{"kind", "state"},
                  {"index", index},
                  {"playing", player.playing()},
                  {"speed", player.speed()},
                  {"loop", player.loop()}});
}

std::string write_notice(NoticeLevel level, std::string_view text) {
  constexpr const char* kNames[] = {"info", "warning", "error"};
  return text_in({{"kind", "notice"}, {"level", kNames[static_cast<int>(level)]}, {"text", text}});
}

Bytes write_sweep_head(const Sweep& sweep, Clock::time_point now) {
  const std::string_view name = std::string_view(sweep.name).substr(0, kMostName);
  double age_ms = 0.0;
  if (sweep.captured) {
    age_ms = std::chrono::duration<double, std::milli>(now - *sweep.captured).count();
  }
  const auto layers = [](int count) {
    return static_cast<std::uint32_t>(std::clamp(count, 0, 0xFFFF));
  };
  Bytes bytes;
  bytes.reserve(kSweepHead + name.size());
  ByteWriter out(bytes);
  out.put(kSweepMagic);
  out.put(sweep.stream);
  out.put(static_cast<std::uint8_t>(sweep.has_original ? kHasOriginal : 0));
  out.put(static_cast<std::uint16_t>(name.size()));
  out.put(sweep.index);
  out.put(static_cast<std::uint32_t>(std::clamp(age_ms, 0.0, 4.0e9)));
  out.put(layers(sweep.layers.there) | layers(sweep.layers.made) << 16);
  out.put_bytes(std::as_bytes(std::span(name)));
  return bytes;
}

Result<Command> read_command(std::string_view text) {
  const Json message = Json::parse(text, nullptr, false);
  if (!message.is_object()) return refuse("a message is no JSON object");
  const auto named = message.find("kind");
  if (named == message.end() || !named->is_string()) return refuse("a message has no \"kind\"");
  const auto kind = named->get<std::string>();
  using Kind = Command::Kind;
  if (kind == "play") return Command{Kind::play};
  if (kind == "pause") return Command{Kind::pause};
  if (kind == "override") return read_override(message);
  if (kind == "more" || kind == "seek") {
    const bool is_more = kind == "more";
    const auto number = number_in(message, is_more ? "count" : "index");
    if (!number) return tl::unexpected(number.error());
    return Command{is_more ? Kind::more : Kind::seek, *number};
  }
  const auto value = message.find("value");
  if (kind == "speed") {
    if (value == message.end() || !value->is_number()) return refuse("\"speed\" has no number");
    return Command{Kind::speed, 0, value->get<double>()};
  }
  if (kind == "loop") {
    if (value == message.end() || !value->is_boolean())
      return refuse("\"loop\" has no truth value");
    return Command{Kind::loop, 0, 1.0, value->get<bool>()};
  }
  return refuse("a message's \"kind\" is unknown");
}

}  // namespace sweepcast::view
