#include "link/fragment.hpp"

#include <algorithm>

#include "codec/frame_edit.hpp"
#include "core/bytes.hpp"

namespace sweepcast::link {

void write_fragment(const Fragment& fragment, std::vector<std::byte>& plain) {
  plain.clear();
  ByteWriter out(plain);
  out.put(fragment.stream);
  out.put(fragment.layer);
  out.put(fragment.layers);
  out.put(std::uint8_t{0});
  out.put(fragment.sweep);
  out.put(fragment.index);
  out.put(fragment.layer_bytes);
  out.put(fragment.sent_us);
  out.put(fragment.remaining_ms);
  out.put_bytes(fragment.payload);
}

std::optional<Fragment> read_fragment(std::span<const std::byte> plain) {
  ByteReader in(plain);
  Fragment fragment;
  fragment.stream = in.get<std::uint8_t>();
  fragment.layer = in.get<std::uint8_t>();
  fragment.layers = in.get<std::uint8_t>();
  const auto reserved = in.get<std::uint8_t>();
  fragment.sweep = in.get<std::uint32_t>();
  fragment.index = in.get<std::uint16_t>();
  fragment.layer_bytes = in.get<std::uint32_t>();
  fragment.sent_us = in.get<std::uint32_t>();
  fragment.remaining_ms = in.get<std::uint16_t>();
  if (!in.ok() || reserved != 0 || fragment.stream >= kMostStreams || fragment.sweep == 0 ||
      fragment.layers > kMostLayers || fragment.layer >= fragment.layers ||
      fragment.layer_bytes > kLargestLayer || fragment.offset() >= fragment.layer_bytes) {
    return std::nullopt;
  }
  const std::size_t size = std::min(kFragmentPayload, fragment.layer_bytes - fragment.offset());
  if (in.remaining() != size) return std::nullopt;
  fragment.payload = in.get_bytes(size);
  return fragment;
}

void write_label(const SweepLabel& label, std::vector<std::byte>& out) {
  ByteWriter writer(out);
  writer.put(label.captured_us);
  writer.put(label.model);
  writer.put_text(label.sensor);
  writer.put_text(label.name);
}

std::optional<SweepLabel> read_label(std::span<const std::byte> bytes,
                                     std::span<const std::byte>& rest) {
  ByteReader in(bytes);
  SweepLabel label;
  label.captured_us = in.get<std::uint32_t>();
  label.model = in.get<std::uint32_t>();
  label.sensor = in.get_text();
  label.name = in.get_text();
  if (!in.ok() || !is_link_name(label.sensor) || label.name.size() > kMostSourceName) {
    return std::nullopt;
  }
  rest = bytes.subspan(in.position());
  return label;
}

Result<std::vector<std::vector<std::byte>>> cut_layers(std::span<const std::byte> frame,
                                                       const SweepLabel& label,
                                                       std::size_t most_bytes) {
  FrameHeader header;
  if (Status status = parse_frame_header(frame, header); !status) {
    return tl::unexpected(status.error());
  }
  if (header.frame_size != frame.size()) {
    return fail(ErrorCode::truncated, "not one whole frame; encode the sweep again");
  }
  std::vector<std::size_t> ends = layer_ends(header);
  if (ends.size() > kMostLayers) ends.erase(ends.begin() + kMostLayers - 1, ends.end() - 1);
  std::vector<std::vector<std::byte>> layers;
  std::size_t begin = 0;
  for (const std::size_t end : ends) {
    if (!layers.empty() && most_bytes > 0 && end > most_bytes) break;
    std::vector<std::byte>& layer = layers.emplace_back();
    if (layers.size() == 1) write_label(label, layer);
    const auto bytes = frame.subspan(begin, end - begin);
    layer.insert(layer.end(), bytes.begin(), bytes.end());
    if (layer.size() > kLargestLayer) {
      return fail(ErrorCode::limit,
                  "a layer of the frame has more than 4 MiB; encode it at a coarser quality");
    }
    if (layer.empty()) layers.pop_back();
    begin = end;
  }
  return layers;
}

}  // namespace sweepcast::link
