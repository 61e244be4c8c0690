// Sensor models in files: JSON that people can read.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "sweepcast/sensor_model.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::app {

/// A model as JSON: ticks_per_turn, direction, jitter_ticks and beams from the highest down, each
/// with tan_elevation, elevation_deg (of it, for the reader), height_m, azimuth_offset_deg,
/// lateral_offset_m, lag_ticks and time_offset_deg; mount where there is one. Decimal fractions
/// give the model's integers back exactly.
[[nodiscard]] nlohmann::ordered_json sensor_json(const SensorModel& model);

/// A mount as JSON: translation_m and rotation_deg, three numbers each.
[[nodiscard]] nlohmann::ordered_json mount_json(const Mount& mount);

/// Reads a model that `sweepcast calibrate` wrote, or the sensor.json of a simulated drive.
/// Errors: not_found, io, limit (over 16 MB), corrupt (no JSON, a member missing or out of its
/// bounds), each with the path and the member at fault.
[[nodiscard]] Result<SensorModel> load_sensor_model(const std::filesystem::path& path);

}  // namespace sweepcast::app
