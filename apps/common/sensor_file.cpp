#include "common/sensor_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/trig.hpp"
#include "io/file.hpp"

namespace sweepcast::app {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxFile = std::size_t{16} << 20;

constexpr std::array<std::pair<std::int32_t, const char*>, 3> kDirections{
    {{1, "counter-clockwise"}, {-1, "clockwise"}, {0, "unknown"}}};

/// What a file's JSON lacks; becomes an error with the file's name.
struct Fault {
  std::string what;
};

double number(const Json& json, const std::string& member) {
  const auto found = json.find(member);
  if (found == json.end() || !found->is_number()) throw Fault{"no number \"" + member + "\""};
  return found->get<double>();
}

std::int32_t units(const Json& json, const std::string& member, double per_one) {
  const double value = std::floor(number(json, member) * per_one + 0.5);
  if (!(std::abs(value) < 2147483647.0)) throw Fault{"\"" + member + "\" is far out of bounds"};
  return static_cast<std::int32_t>(value);
}

std::array<std::int32_t, 3> vector_from(const Json& json, const std::string& member,
                                        double per_one) {
  const auto found = json.find(member);
  if (found == json.end() || !found->is_array() || found->size() != 3) {
    throw Fault{"no three numbers \"" + member + "\""};
  }
  std::array<std::int32_t, 3> vector{};
  for (std::size_t i = 0; i < 3; ++i) {
    vector[i] = units(Json{{member, (*found)[i]}}, member, per_one);
  }
  return vector;
}

Mount mount_from(const Json& json) {
  return {vector_from(json, "translation_m", kLengthUnits),
          vector_from(json, "rotation_deg", kAngleUnits)};
}

SensorModel model_from(const Json& json) {
  SensorModel model;
  model.ticks_per_turn = units(json, "ticks_per_turn", 1.0);
  if (json.contains("jitter_ticks")) model.jitter = units(json, "jitter_ticks", 1.0);
  for (const auto& [direction, word] : kDirections) {
    if (json.contains("direction") && json["direction"] == word) model.direction = direction;
  }
  if (json.contains("mount")) model.mount = mount_from(json["mount"]);
  const auto beams = json.find("beams");
  if (beams == json.end() || !beams->is_array()) throw Fault{"no list \"beams\""};
  if (beams->size() > static_cast<std::size_t>(kMaxBeams)) throw Fault{"over 1024 beams"};
  for (const Json& beam : *beams) {
    Beam b;
    b.tan_elevation = units(beam, "tan_elevation", kTangentUnits);
    b.height = units(beam, "height_m", kLengthUnits);
    b.azimuth_offset = units(beam, "azimuth_offset_deg", kAngleUnits);
    b.lateral_offset = units(beam, "lateral_offset_m", kLengthUnits);
    b.lag = units(beam, "lag_ticks", 1.0);
    if (beam.contains("time_offset_deg")) {
      b.time_offset = units(beam, "time_offset_deg", kAngleUnits);
    }
    if (beam.contains("interpolated_ticks")) {
      b.interpolated = units(beam, "interpolated_ticks", 1.0);
    }
    model.beams.push_back(b);
  }
  std::stable_sort(model.beams.begin(), model.beams.end(),
                   [](const Beam& a, const Beam& b) { return a.tan_elevation > b.tan_elevation; });
  return model;
}

}  // namespace

Json mount_json(const Mount& mount) {
  Json json;
  for (const std::int32_t v : mount.translation) {
    json["translation_m"].push_back(static_cast<double>(v) / kLengthUnits);
  }
  for (const std::int32_t v : mount.rotation) {
    json["rotation_deg"].push_back(static_cast<double>(v) / kAngleUnits);
  }
  return json;
}

Json sensor_json(const SensorModel& model) {
  Json json{{"ticks_per_turn", model.ticks_per_turn}};
  for (const auto& [direction, word] : kDirections) {
    if (model.direction == direction) json["direction"] = word;
  }
  json["jitter_ticks"] = model.jitter;
  if (model.mount != Mount{}) json["mount"] = mount_json(model.mount);
  json["beams"] = Json::array();
  for (const Beam& beam : model.beams) {
    const double tangent = static_cast<double>(beam.tan_elevation) / kTangentUnits;
    const double elevation = arc_tangent(tangent, 1.0) / kDegree;
    json["beams"].push_back(
        {{"tan_elevation", tangent},
         {"elevation_deg", std::floor(elevation * 1e4 + 0.5) / 1e4},
         {"height_m", static_cast<double>(beam.height) / kLengthUnits},
         {"azimuth_offset_deg", static_cast<double>(beam.azimuth_offset) / kAngleUnits},
         {"lateral_offset_m", static_cast<double>(beam.lateral_offset) / kLengthUnits},
         {"lag_ticks", beam.lag},
         {"time_offset_deg", static_cast<double>(beam.time_offset) / kAngleUnits}});
    if (beam.interpolated != 0) json["beams"].back()["interpolated_ticks"] = beam.interpolated;
  }
  return json;
}

Result<SensorModel> load_sensor_model(const std::filesystem::path& path) {
  std::vector<std::byte> bytes;
  if (Status read = read_file(path, kMaxFile, bytes); !read) return tl::unexpected(read.error());
  const auto wrong = [&path](const std::string& what) {
    return fail(ErrorCode::corrupt,
                path.string() + ": " + what + "; make it anew with `sweepcast calibrate`");
  };
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  const Json json = Json::parse(text, text + bytes.size(), nullptr, false);
  if (json.is_discarded() || !json.is_object()) return wrong("not a JSON object");
  try {
    SensorModel model = model_from(json);
    if (const Status sound = check(model); !sound) return wrong(sound.error().message);
    return model;
  } catch (const Fault& fault) {
    return wrong(fault.what);
  } catch (const nlohmann::json::exception&) {
    return wrong("a member is of the wrong kind");
  }
}

}  // namespace sweepcast::app
