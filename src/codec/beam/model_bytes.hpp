// A sensor model, firings and motion as bytes.
#pragma once

#include <cstdint>
#include <vector>

#include "core/bytes.hpp"
#include "sweepcast/sensor_model.hpp"

namespace sweepcast::beam {

/// Writes a model that has passed `check`; beams as differences from the one before.
void write_model(const SensorModel& model, ByteWriter& out);

/// The inverse; false where the bytes end early or the model does not pass `check`.
[[nodiscard]] bool read_model(ByteReader& in, SensorModel& model);

/// Writes a motion that has passed `check`, its `zero_tick` not negative.
void write_motion(const Motion& motion, ByteWriter& out);

/// The inverse; what it gives has yet to pass `check`.
[[nodiscard]] Motion read_motion(ByteReader& in);

/// Writes increasing ticks. They are nearly periodic: what the decoder has seen follow the last
/// few steps is packed well. `held`: of each, whether the firing was held; empty where the sensor's
/// model has no interpolated lags.
void write_firings(std::span<const std::int32_t> ticks, std::vector<std::byte>& out,
                   std::span<const std::uint8_t> held = {});

/// The inverse: fills `ticks`, whose size says how many, and `held`, as many or none. False unless
/// ticks increase and are below `ticks_per_turn`.
[[nodiscard]] bool read_firings(std::span<const std::byte> bytes, std::int32_t ticks_per_turn,
                                std::span<std::int32_t> ticks, std::span<std::uint8_t> held = {});

}  // namespace sweepcast::beam
