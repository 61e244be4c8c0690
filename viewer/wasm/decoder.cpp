// The decoder as the page calls it: a frame's bytes in, columns of points out.
//
//   frame = sweepcast_frame(size)        where to put the frame's bytes; 0 where it is too large
//   sweep = sweepcast_decode(size, ...)  a `DecodedSweep`, which stays until the next call
//
// src/wasm_decoder.ts is the other side. Addresses and sizes are numbers of 32 bits.
#include "sweepcast/decoder.hpp"

#include <emscripten/emscripten.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sweepcast::viewer {
namespace {

constexpr std::size_t kMostFrameBytes = std::size_t{1} << 28;  ///< as in a .sweep file
constexpr std::size_t kMostPoints = std::size_t{1} << 22;      ///< what a page can still draw

/// What the page reads, word by word. A column that the frame does not carry is null.
struct DecodedSweep {
  std::uint32_t ok;
  const char* message;  ///< what is wrong, where `ok` is 0
  std::uint32_t message_size;
  std::uint32_t points;
  const float* xyz;  ///< three a point, metres
  const float* intensity;
  const std::uint16_t* ring;
  const std::int64_t* time_ns;
  const std::uint8_t* filled;
  const char* sensor;
  std::uint32_t sensor_size;
  std::uint32_t codec;
  std::uint32_t width;  ///< points in a row of an organised cloud, else 0
  SweepCounts counts;
  double sequence;
  double stamp_s;
};
static_assert(sizeof(DecodedSweep) == 26 * 4, "src/wasm_decoder.ts counts on it");

/// All that is kept from one sweep to the next.
struct Desk {
  std::vector<std::byte> frame;
  Decoder decoder;
  bool fill = false;
  int layers = 0;
  PointCloud cloud;
  std::vector<float> xyz;
  std::string message;
  DecodedSweep sweep{};
};

Desk& desk() {
  static Desk the_only_one;
  return the_only_one;
}

template <class Value>
const Value* column(const std::vector<Value>& values) {
  return values.empty() ? nullptr : values.data();
}

void interleave(const PointCloud& cloud, std::vector<float>& xyz) {
  xyz.resize(cloud.size() * 3);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    xyz[3 * i] = cloud.x[i];
    xyz[3 * i + 1] = cloud.y[i];
    xyz[3 * i + 2] = cloud.z[i];
  }
}

void describe(Desk& at) {
  const FrameHeader& header = at.decoder.last_header();
  DecodedSweep& sweep = at.sweep;
  sweep.ok = 1;
  sweep.points = static_cast<std::uint32_t>(at.cloud.size());
  sweep.xyz = column(at.xyz);
  sweep.intensity = column(at.cloud.intensity);
  sweep.ring = column(at.cloud.ring);
  sweep.time_ns = column(at.cloud.time_ns);
  sweep.filled = column(at.cloud.filled);
  sweep.sensor = header.sensor.data();
  sweep.sensor_size = static_cast<std::uint32_t>(header.sensor.size());
  sweep.codec = static_cast<std::uint32_t>(header.codec);
  sweep.width = at.cloud.width;
  sweep.counts = header.counts;
  sweep.sequence = static_cast<double>(header.sequence);
  sweep.stamp_s = static_cast<double>(header.stamp_ns) / 1e9;
}

}  // namespace
}  // namespace sweepcast::viewer

extern "C" {

EMSCRIPTEN_KEEPALIVE std::byte* sweepcast_frame(std::uint32_t size) {
  using namespace sweepcast::viewer;
  if (size > kMostFrameBytes) return nullptr;
  desk().frame.resize(size);
  return desk().frame.data();
}

/// Decodes the first `size` bytes of what `sweepcast_frame` gave. `fill`: 1 to append what was left
/// out as interpolation has it; `layers`: decode so many at most.
EMSCRIPTEN_KEEPALIVE const sweepcast::viewer::DecodedSweep* sweepcast_decode(std::uint32_t size,
                                                                             std::uint32_t fill,
                                                                             std::uint32_t layers) {
  using namespace sweepcast::viewer;
  Desk& at = desk();
  if (at.layers != static_cast<int>(layers) || at.fill != (fill != 0)) {
    at.layers = static_cast<int>(layers);
    at.fill = fill != 0;
    at.decoder =
        sweepcast::Decoder({.max_points = kMostPoints, .max_layers = at.layers, .fill = at.fill});
  }
  at.sweep = {};
  const std::span<const std::byte> frame(at.frame.data(),
                                         std::min<std::size_t>(size, at.frame.size()));
  if (const sweepcast::Status status = at.decoder.decode(frame, at.cloud); !status) {
    at.message = status.error().message;
    at.sweep.message = at.message.data();
    at.sweep.message_size = static_cast<std::uint32_t>(at.message.size());
    return &at.sweep;
  }
  interleave(at.cloud, at.xyz);
  describe(at);
  return &at.sweep;
}
}
