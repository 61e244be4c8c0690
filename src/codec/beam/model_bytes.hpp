// A sensor model, firings and motion as bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/entropy/mixer.hpp"
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

/// Codes increasing ticks. They are nearly periodic: what the decoder has seen follow the last few
/// steps is packed well. Keeps its tables. `held`: of each, whether the firing was held; empty
/// where the sensor's model has no interpolated lags.
class FiringCoder {
 public:
  void write(std::span<const std::int32_t> ticks, std::vector<std::byte>& out,
             std::span<const std::uint8_t> held = {});

  /// The inverse: fills `ticks`, whose size says how many, and `held`, as many or none. False
  /// unless ticks increase and are below `ticks_per_turn`.
  [[nodiscard]] bool read(std::span<const std::byte> bytes, std::int32_t ticks_per_turn,
                          std::span<std::int32_t> ticks, std::span<std::uint8_t> held = {});

 private:
  void reset();
  template <class Coder>
  std::uint32_t code(Coder& coder, std::uint32_t step);
  template <class Coder>
  bool code_hold(Coder& coder, bool held);

  static constexpr std::uint32_t kUnary = 24;
  BitMixer<3> mixer_{12, 1};
  std::array<std::uint32_t, 6> last_{};  // steps between firings, less one
  std::uint32_t history_ = 0;            // of the last 16 steps
  BitMixer<3> hold_mixer_{12, 1};
  std::uint32_t holds_ = 0;  // of the last 32 firings, whether they were held
};

}  // namespace sweepcast::beam
