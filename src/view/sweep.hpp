// What the viewer's server shows: sweeps as frames, and whose they are.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "codec/frame_edit.hpp"

namespace sweepcast::view {

using Bytes = std::vector<std::byte>;
/// Bytes that many clients are sent, held once.
using SharedBytes = std::shared_ptr<const Bytes>;
using Clock = std::chrono::steady_clock;

inline constexpr std::size_t kMostStreams = 256;  ///< a stream's id is one byte

/// A sensor of a robot.
struct Stream {
  std::uint8_t id = 0;
  std::string robot;
  std::string sensor;
};

/// A sweep as clients are sent it.
struct Sweep {
  std::uint8_t stream = 0;
  bool has_original = false;  ///< the sweep before it was coded can be asked for
  std::uint32_t index = 0;    ///< of a recording: the frame's number; live: counts the stream's
  std::string name;           ///< of its source; may be empty
  SharedBytes frame;          ///< decodes alone, with the sensor's model
  LayerCounts layers;
  std::optional<Clock::time_point> captured;  ///< live: when it was measured
};
using SharedSweep = std::shared_ptr<const Sweep>;

/// What is on: the same for all clients.
struct Show {
  bool is_live = false;
  std::string title;
  double rate_hz = 10.0;                ///< sweeps a second
  std::optional<std::uint32_t> frames;  ///< of a recording
  bool has_original = false;            ///< some sweep has its original
  std::vector<Stream> streams;
};

}  // namespace sweepcast::view
