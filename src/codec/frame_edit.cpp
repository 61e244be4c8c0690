#include "codec/frame_edit.hpp"

#include <algorithm>

#include "codec/beam/codec.hpp"
#include "codec/frame_layout.hpp"

namespace sweepcast {
namespace {

constexpr auto kModel = static_cast<std::uint8_t>(beam::Part::model);
constexpr auto kFirstLayer = static_cast<std::uint8_t>(beam::Part::layer);
constexpr auto kFirstAttributes = static_cast<std::uint8_t>(beam::Part::layer_attributes);

bool begins_further_layer(const FramePart& part) {
  return part.kind > kFirstLayer && part.kind < kFirstAttributes;
}

}  // namespace

std::vector<std::size_t> layer_ends(const FrameHeader& header) {
  std::vector<std::size_t> ends;
  if (header.codec == CodecId::beam) {
    for (const FramePart& part : header.parts) {
      if (begins_further_layer(part)) ends.push_back(part.offset);
    }
  }
  ends.push_back(header.frame_size);
  return ends;
}

Result<LayerCounts> count_layers(std::span<const std::byte> frame, const FrameHeader& header) {
  if (header.codec != CodecId::beam) return LayerCounts{};
  const auto grid = checked_part(frame, header, static_cast<std::uint8_t>(beam::Part::grid));
  if (!grid) return tl::unexpected(grid.error());
  const LayerCounts counts{static_cast<int>(layer_ends(header).size()),
                           beam::layers_of_grid(*grid).value_or(0)};
  if (counts.missing() >= 0) return counts;
  return fail(ErrorCode::corrupt, "the frame's grid cannot be right");
}

Result<std::span<const std::byte>> model_part(std::span<const std::byte> frame,
                                              const FrameHeader& header) {
  if (header.codec != CodecId::beam || !has_part(header, kModel)) {
    return std::span<const std::byte>{};
  }
  auto part = checked_part(frame, header, kModel);
  if (!part && part.error().code == ErrorCode::truncated) return std::span<const std::byte>{};
  return part;
}

Status rewrite_frame(std::span<const std::byte> frame, ModelPart what,
                     std::span<const std::byte> model, std::vector<std::byte>& out) {
  FrameHeader header;
  if (Status status = parse_frame_header(frame, header); !status) return status;
  const std::vector<std::size_t> ends = layer_ends(header);
  const auto whole = std::upper_bound(ends.begin(), ends.end(), frame.size());
  if (whole == ends.begin()) return fail(ErrorCode::truncated, "the frame ends in its first layer");
  const std::size_t end = *(whole - 1);

  PartList parts;
  if (header.codec != CodecId::beam) what = ModelPart::keep;
  if (what == ModelPart::put) parts.begin(kModel).put_bytes(model);
  for (const FramePart& part : header.parts) {
    if (part.offset + part.size > end || (part.offset == end && part.size == 0)) break;
    if (part.kind == kModel && what != ModelPart::keep) continue;
    // Its checksum is made anew, so damage must be seen now.
    const auto bytes = checked_part(frame, header, part.kind);
    if (!bytes) return tl::unexpected(bytes.error());
    parts.begin(part.kind).put_bytes(*bytes);
  }
  const SweepInfo info{header.sequence, header.stamp_ns, header.sensor};
  write_frame(header.codec, info, header.counts, parts, out);
  return {};
}

}  // namespace sweepcast
