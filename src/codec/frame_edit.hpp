// Frames cut to fewer layers, and with or without their sensor's model: what a link does to them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sweepcast/frame.hpp"

namespace sweepcast {

/// Where the layers of a frame end, bytes from its start, coarsest first: the frame's first
/// `layer_ends(header)[k]` bytes hold k + 1 layers, whole, and all that these need. What follows
/// the last layer (exact coordinates, order) belongs to it. A codec without layers has one.
[[nodiscard]] std::vector<std::size_t> layer_ends(const FrameHeader& header);

/// Layers of a frame.
struct LayerCounts {
  int there = 1;  ///< in the frame
  int made = 1;   ///< that the encoder made; more than are there where a link cut the frame

  [[nodiscard]] int missing() const noexcept { return made - there; }
};

/// Counts the layers of a whole frame. Error corrupt: what the frame says of them is damaged.
[[nodiscard]] Result<LayerCounts> count_layers(std::span<const std::byte> frame,
                                               const FrameHeader& header);

/// The sensor's model in a frame; empty where it has none or is cut before its end.
/// Error corrupt: the model does not match its checksum.
[[nodiscard]] Result<std::span<const std::byte>> model_part(std::span<const std::byte> frame,
                                                            const FrameHeader& header);

/// What `rewrite_frame` does with the sensor's model.
enum class ModelPart : std::uint8_t {
  keep,  ///< as it is
  drop,  ///< leave it out: the decoder has it from another frame
  put,   ///< put the given one in, in the place of what there is
};

/// Writes a whole frame to `out` of the parts of `frame` that are there in full: one that was cut
/// after a layer becomes a frame of fewer layers. `model` is for `ModelPart::put`.
/// Errors: those of `parse_frame_header`; corrupt (a part does not match its checksum); truncated,
/// where not even the first layer is whole.
[[nodiscard]] Status rewrite_frame(std::span<const std::byte> frame, ModelPart what,
                                   std::span<const std::byte> model, std::vector<std::byte>& out);

}  // namespace sweepcast
