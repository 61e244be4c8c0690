#include "sweepcast/sensor_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "core/trig.hpp"
#include "sensor/beam_geometry.hpp"

namespace sweepcast {
namespace {

constexpr std::int32_t kMaxTangent = 100 * kTangentUnits;
constexpr std::int32_t kMaxOffset = 10 * kLengthUnits;
constexpr std::int32_t kMaxJitter = 4096;
constexpr std::int32_t kMaxAngle = 360 * kAngleUnits;

bool within(std::int32_t value, std::int32_t limit) {
  return value >= -limit && value <= limit;
}

bool is_sound(const Mount& mount) {
  constexpr std::int32_t kMaxTranslation = 100 * kLengthUnits;
  constexpr std::int32_t kMaxRotation = 90 * kAngleUnits;
  bool sound = true;
  for (const std::int32_t v : mount.translation) sound = sound && within(v, kMaxTranslation);
  for (const std::int32_t w : mount.rotation) sound = sound && within(w, kMaxRotation);
  return sound;
}

}  // namespace

Status check(const SensorModel& model) {
  const auto wrong = [](const std::string& what) {
    return fail(ErrorCode::invalid_argument, "sensor model: " + what);
  };
  if (model.beams.empty() || model.beams.size() > static_cast<std::size_t>(kMaxBeams)) {
    return wrong(std::to_string(model.beams.size()) + " beams; 1 to 1024 can be");
  }
  if (model.ticks_per_turn < 1 || model.ticks_per_turn > kMaxTicks) {
    return wrong(std::to_string(model.ticks_per_turn) + " ticks per turn; 1 to 1048576 can be");
  }
  if (!within(model.direction, 1)) return wrong("direction must be -1, 0 or 1");
  if (model.jitter < 0 || model.jitter > std::min(model.ticks_per_turn / 2, kMaxJitter)) {
    return wrong("jitter of " + std::to_string(model.jitter) +
                 " ticks; at most half a turn and 4096 can be");
  }
  if (!is_sound(model.mount)) return wrong("mount beyond 100 m or 90 degrees");
  for (std::size_t k = 0; k < model.beams.size(); ++k) {
    const Beam& beam = model.beams[k];
    const std::string name = "beam " + std::to_string(k);
    if (!within(beam.tan_elevation, kMaxTangent)) return wrong(name + ": tan_elevation beyond 100");
    if (!within(beam.height, kMaxOffset)) return wrong(name + ": height beyond 10 m");
    if (!within(beam.lateral_offset, kMaxOffset)) {
      return wrong(name + ": lateral_offset beyond 10 m");
    }
    if (!within(beam.azimuth_offset, kMaxAngle)) {
      return wrong(name + ": azimuth_offset beyond 360 degrees");
    }
    if (!within(beam.time_offset, kMaxAngle))
      return wrong(name + ": time_offset beyond 360 degrees");
    if (!within(beam.lag, model.ticks_per_turn)) return wrong(name + ": lag beyond a turn");
    if (!within(beam.interpolated, model.ticks_per_turn)) {
      return wrong(name + ": interpolated lag beyond a turn");
    }
    if (k > 0 && beam.tan_elevation > model.beams[k - 1].tan_elevation) {
      return wrong(name + ": not below the one before; beams go from the highest down");
    }
  }
  return {};
}

Status check(const Motion& motion, const SensorModel& model) {
  constexpr std::int32_t kMaxTranslation = 1000 * kLengthUnits;
  constexpr std::int32_t kMaxRotation = 90 * kAngleUnits;
  bool sound = within(motion.zero_tick, model.ticks_per_turn) &&
               within(motion.nod, kTangentUnits) && is_sound(motion.mount);
  for (const std::int32_t v : motion.translation) sound = sound && within(v, kMaxTranslation);
  for (const std::int32_t w : motion.rotation) sound = sound && within(w, kMaxRotation);
  if (sound) return {};
  return fail(
      ErrorCode::invalid_argument,
      "motion: beyond 1 km, 90 degrees or a turn's ticks, or its mount beyond 100 m; no robot "
      "moves so in a sweep");
}

bool has_interpolated_lags(const SensorModel& model) {
  return std::any_of(model.beams.begin(), model.beams.end(),
                     [](const Beam& beam) { return beam.interpolated != 0; });
}

std::vector<std::int32_t> interpolated_lags(const SensorModel& model) {
  std::vector<std::int32_t> ticks;
  if (!has_interpolated_lags(model)) return ticks;
  for (const Beam& beam : model.beams) ticks.push_back(beam.interpolated);
  return ticks;
}

std::vector<BeamGeometry> beam_geometry(const SensorModel& model) {
  std::vector<BeamGeometry> beams;
  beams.reserve(model.beams.size());
  for (const Beam& beam : model.beams) {
    BeamGeometry g;
    g.tan = static_cast<double>(beam.tan_elevation) / kTangentUnits;
    g.slant = std::sqrt(1.0 + g.tan * g.tan);
    g.inverse_slant = 1.0 / g.slant;
    g.height_m = static_cast<double>(beam.height) / kLengthUnits;
    g.lateral_m = static_cast<double>(beam.lateral_offset) / kLengthUnits;
    const double turns = static_cast<double>(beam.azimuth_offset) / (360.0 * kAngleUnits);
    g.phase = turns * model.ticks_per_turn;
    g.azimuth = 2.0 * kPi *
                (turns + static_cast<double>(beam.lag) / static_cast<double>(model.ticks_per_turn));
    g.time_turns = static_cast<double>(beam.time_offset) / (360.0 * kAngleUnits);
    beams.push_back(g);
  }
  return beams;
}

}  // namespace sweepcast
