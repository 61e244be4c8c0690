// Fragments: the pieces that a sweep's layers travel in. docs/format-link.md has the bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "link/packet.hpp"

namespace sweepcast::link {

/// Microseconds of a clock that never jumps, of which a packet carries the low 32 bits.
using Microseconds = std::int64_t;

/// `later - earlier` of two 32-bit times, within +-35 minutes.
[[nodiscard]] constexpr std::int32_t wrapped_difference(std::uint32_t later,
                                                        std::uint32_t earlier) noexcept {
  return static_cast<std::int32_t>(later - earlier);
}

inline constexpr std::size_t kFragmentHeadBytes = 20;
inline constexpr std::size_t kFragmentPayload = kMostPlainBytes - kFragmentHeadBytes;
inline constexpr std::size_t kLargestLayer = std::size_t{4} << 20;
inline constexpr std::uint8_t kMostStreams = 16;
inline constexpr std::uint8_t kMostLayers = 16;

/// One fragment. All but the last of a layer have kFragmentPayload bytes.
struct Fragment {
  std::uint8_t stream = 0;         ///< number of the sensor within the connection
  std::uint8_t layer = 0;          ///< 0 is the coarsest
  std::uint8_t layers = 1;         ///< that the sweep has
  std::uint32_t sweep = 0;         ///< counts the sweeps of the stream, from 1
  std::uint16_t index = 0;         ///< within the layer
  std::uint32_t layer_bytes = 0;   ///< 1 to kLargestLayer
  std::uint32_t sent_us = 0;       ///< the sender's clock when it left
  std::uint16_t remaining_ms = 0;  ///< until the sweep's deadline, when it left
  std::span<const std::byte> payload;

  [[nodiscard]] std::size_t offset() const { return std::size_t{index} * kFragmentPayload; }
};

/// Fragments of a layer of so many bytes.
[[nodiscard]] constexpr std::size_t fragment_count(std::size_t layer_bytes) noexcept {
  return (layer_bytes + kFragmentPayload - 1) / kFragmentPayload;
}

/// Writes a fragment to `plain`, whose memory is reused.
void write_fragment(const Fragment& fragment, std::vector<std::byte>& plain);

/// Reads one; the payload refers to `plain`. None where a number is out of bounds or the payload's
/// size is not what its place asks for.
[[nodiscard]] std::optional<Fragment> read_fragment(std::span<const std::byte> plain);

/// What the first layer begins with, before the frame.
struct SweepLabel {
  std::uint32_t captured_us = 0;  ///< the sender's clock
  std::uint32_t model = 0;        ///< crc32 of the sensor's model that the frame needs; 0: none
  std::string sensor;
  std::string name;
};

void write_label(const SweepLabel& label, std::vector<std::byte>& out);
/// Reads a label; `rest` is what follows. None where a size or a name cannot be.
[[nodiscard]] std::optional<SweepLabel> read_label(std::span<const std::byte> bytes,
                                                   std::span<const std::byte>& rest);

inline constexpr std::size_t kMostSourceName = 64;

/// Cuts a frame into the layers to send; the first one begins with the label. A frame of more than
/// kMostLayers keeps the rest in the last. Of the layers after the first, those that end beyond
/// `most_bytes` of the frame are left out, unless it is 0.
/// Errors: those of `parse_frame_header`; truncated; limit (a layer over kLargestLayer).
[[nodiscard]] Result<std::vector<std::vector<std::byte>>> cut_layers(
    std::span<const std::byte> frame, const SweepLabel& label, std::size_t most_bytes = 0);

}  // namespace sweepcast::link
