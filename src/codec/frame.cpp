#include "sweepcast/frame.hpp"

#include <algorithm>
#include <array>

#include "codec/beam/codec.hpp"
#include "codec/frame_layout.hpp"
#include "codec/rcpcc/codec.hpp"
#include "core/bytes.hpp"
#include "core/crc32.hpp"

namespace sweepcast {
namespace {

// The counts in the order in which every frame has them; those of codec beam add `thinned`.
constexpr std::array kCounts = {&SweepCounts::points_in,  &SweepCounts::points_coded,
                                &SweepCounts::not_finite, &SweepCounts::zero_range,
                                &SweepCounts::cropped,    &SweepCounts::out_of_view,
                                &SweepCounts::collided};

Status read_head(ByteReader& in, FrameHeader& header) {
  if (in.get<std::uint32_t>() != kFrameMagic) {
    return fail(ErrorCode::corrupt, "not a frame: it does not begin with SWPF");
  }
  header.version = in.get<std::uint8_t>();
  if (in.ok() && header.version != kFrameVersion) {
    return fail(ErrorCode::unsupported, "frame version " + std::to_string(header.version) +
                                            " is newer than this program; update it");
  }
  header.codec = static_cast<CodecId>(in.get<std::uint8_t>());
  header.sequence = in.get_varint();
  header.stamp_ns = in.get<std::int64_t>();
  header.sensor = in.get_text();
  for (const auto count : kCounts) {
    header.counts.*count = static_cast<std::uint32_t>(in.get_varint(0xFFFFFFFFU));
  }
  header.counts.thinned =
      header.codec == CodecId::beam ? static_cast<std::uint32_t>(in.get_varint(0xFFFFFFFFU)) : 0;
  header.parts.resize(in.get_varint(kMostParts));
  for (FramePart& part : header.parts) {
    part.kind = in.get<std::uint8_t>();
    part.size = in.get_varint(kLargestFrame);
    part.crc32 = in.get<std::uint32_t>();
  }
  return {};
}

void write_head(CodecId codec, const SweepInfo& info, const SweepCounts& counts, std::size_t parts,
                ByteWriter& out) {
  out.put(kFrameMagic);
  out.put(kFrameVersion);
  out.put(static_cast<std::uint8_t>(codec));
  out.put_varint(info.sequence);
  out.put(info.stamp_ns);
  out.put_text(info.sensor);
  for (const auto count : kCounts) out.put_varint(counts.*count);
  if (codec == CodecId::beam) out.put_varint(counts.thinned);
  out.put_varint(parts);
}

}  // namespace

std::string_view name(CodecId codec) noexcept {
  switch (codec) {
    case CodecId::rcpcc:
      return "rcpcc";
    case CodecId::beam:
      return "beam";
  }
  return "unknown";
}

std::string_view part_name(CodecId codec, std::uint8_t kind) noexcept {
  switch (codec) {
    case CodecId::rcpcc:
      return rcpcc::part_name(kind);
    case CodecId::beam:
      return beam::part_name(kind);
  }
  return "unknown";
}

Status parse_frame_header(std::span<const std::byte> bytes, FrameHeader& header) {
  header.parts.clear();
  ByteReader in(bytes);
  if (Status status = read_head(in, header); !status) return status;
  const std::size_t checked = in.position();
  const auto checksum = in.get<std::uint32_t>();
  if (!in.ok()) {
    return fail(in.ran_out() ? ErrorCode::truncated : ErrorCode::corrupt,
                "the head of the frame is cut short or damaged");
  }
  if (checksum != crc32(bytes.first(checked))) {
    return fail(ErrorCode::corrupt, "the head of the frame is damaged: its checksum is wrong");
  }
  header.header_size = in.position();
  header.frame_size = header.header_size;
  for (FramePart& part : header.parts) {
    part.offset = header.frame_size;
    header.frame_size += part.size;
  }
  if (header.frame_size > kLargestFrame) {
    return fail(ErrorCode::limit, "the frame announces more than 256 MiB");
  }
  return {};
}

void PartList::clear() {
  parts_.clear();
  bytes_.clear();
}

ByteWriter PartList::begin(std::uint8_t kind) {
  parts_.push_back({kind, bytes_.size()});
  return ByteWriter(bytes_);
}

void PartList::truncate(std::size_t count) {
  if (count >= parts_.size()) return;
  bytes_.resize(parts_[count].begin);
  parts_.resize(count);
}

std::span<const std::byte> PartList::part(std::size_t i) const {
  const std::size_t end = i + 1 == parts_.size() ? bytes_.size() : parts_[i + 1].begin;
  return std::span(bytes_).subspan(parts_[i].begin, end - parts_[i].begin);
}

void write_frame(CodecId codec, const SweepInfo& info, const SweepCounts& counts,
                 const PartList& parts, std::vector<std::byte>& frame) {
  frame.clear();
  ByteWriter out(frame);
  write_head(codec, info, counts, parts.size(), out);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    out.put(parts.kind(i));
    out.put_varint(parts.part(i).size());
    out.put(crc32(parts.part(i)));
  }
  out.put(crc32(frame));
  for (std::size_t i = 0; i < parts.size(); ++i) out.put_bytes(parts.part(i));
}

std::size_t frame_size(CodecId codec, const SweepInfo& info, const SweepCounts& counts,
                       const PartList& parts, std::size_t first) {
  constexpr std::size_t kChecksum = sizeof(std::uint32_t);
  std::vector<std::byte> head;
  ByteWriter out(head);
  write_head(codec, info, counts, parts.size() - first, out);
  std::size_t size = kChecksum;
  for (std::size_t i = first; i < parts.size(); ++i) {
    out.put(parts.kind(i));
    out.put_varint(parts.part(i).size());
    size += parts.part(i).size() + kChecksum;
  }
  return size + head.size();
}

bool has_part(const FrameHeader& header, std::uint8_t kind) {
  return std::any_of(header.parts.begin(), header.parts.end(),
                     [kind](const FramePart& part) { return part.kind == kind; });
}

Result<std::span<const std::byte>> checked_part(std::span<const std::byte> frame,
                                                const FrameHeader& header, std::uint8_t kind) {
  const auto part = std::find_if(header.parts.begin(), header.parts.end(),
                                 [kind](const FramePart& p) { return p.kind == kind; });
  const auto what = [&] { return "\"" + std::string(part_name(header.codec, kind)) + "\""; };
  if (part == header.parts.end()) {
    return fail(ErrorCode::corrupt, "the frame has no part " + what());
  }
  if (part->offset + part->size > frame.size()) {
    return fail(ErrorCode::truncated, "the frame ends within part " + what());
  }
  const auto bytes = frame.subspan(part->offset, part->size);
  if (crc32(bytes) != part->crc32) {
    return fail(ErrorCode::corrupt, "part " + what() + " is damaged: its checksum is wrong");
  }
  return bytes;
}

}  // namespace sweepcast
