#include "io/sweep_layout.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "codec/frame_layout.hpp"
#include "core/bytes.hpp"
#include "core/crc32.hpp"

namespace sweepcast {
namespace {

/// Eight characters as the integer that has their bytes, in order, when written little-endian.
constexpr std::uint64_t magic(std::string_view text) {
  std::uint64_t value = 0;
  for (std::size_t i = 8; i-- > 0;) value = (value << 8) | static_cast<unsigned char>(text[i]);
  return value;
}

constexpr std::uint64_t kHeadMagic = magic("SWEEPCST");
constexpr std::uint64_t kTrailerMagic = magic("SWEEPEND");
constexpr std::uint16_t kVersion = 1;
/// Stands where a record has the size of its frame.
constexpr std::uint32_t kIndexMarker = 0xFFFFFFFFU;

void put_crc(std::vector<std::byte>& out, std::size_t begin) {
  const std::uint32_t crc = crc32(std::span(out).subspan(begin));
  for (unsigned i = 0; i < 4; ++i) out.push_back(static_cast<std::byte>(crc >> (8 * i)));
}

std::size_t shared_prefix(std::string_view a, std::string_view b) {
  const auto end = a.begin() + static_cast<std::ptrdiff_t>(std::min(a.size(), b.size()));
  return static_cast<std::size_t>(std::mismatch(a.begin(), end, b.begin()).first - a.begin());
}

Status check_head(const ReadAt& read_at, std::uint64_t size, const std::string& label) {
  std::array<std::byte, kSweepHeadSize> head{};
  const std::uint64_t held = std::min<std::uint64_t>(size, head.size());
  const auto part = std::span(head).first(static_cast<std::size_t>(held));
  if (Status status = read_at(0, part); !status) return status;
  if (size == 0) return fail(ErrorCode::corrupt, label + ": is empty; encode or record it again");
  ByteReader reader(part);
  if (reader.get<std::uint64_t>() != kHeadMagic) {
    return fail(ErrorCode::corrupt, label + ": is not a .sweep file; `sweepcast encode` makes one");
  }
  const auto version = reader.get<std::uint16_t>();
  const auto flags = reader.get<std::uint16_t>();
  const std::uint32_t crc = crc32(part.first(std::min(part.size(), reader.position())));
  if (reader.get<std::uint32_t>() != crc || !reader.ok()) {
    return fail(ErrorCode::corrupt, label + ": its head is damaged; copy it again");
  }
  if (version == kVersion && flags == 0) return {};
  return fail(ErrorCode::unsupported, label + ": is a .sweep file of version " +
                                          std::to_string(version) +
                                          "; update Sweepcast to read it");
}

/// Reads the entries from the bytes of an index whose checksum is right. False where they do not
/// fill the file exactly from its head to `index_begin`.
bool read_entries(std::span<const std::byte> index, std::uint64_t index_begin,
                  std::vector<SweepEntry>& entries) {
  ByteReader reader(index);
  if (reader.get<std::uint32_t>() != kIndexMarker) return false;
  const std::uint64_t count = reader.get_varint(kMaxFrames);
  std::uint64_t at = kSweepHeadSize;
  std::string name;
  for (std::uint64_t i = 0; i < count && reader.ok(); ++i) {
    SweepEntry entry;
    entry.size = reader.get_varint(kLargestFrame);
    const auto shared = reader.get<std::uint8_t>();
    const std::string_view rest = reader.get_text();
    if (shared > name.size() || shared + rest.size() > kMaxNameSize) return false;
    name.resize(shared);
    name += rest;
    entry.name = name;
    entry.offset = at + kRecordHeadSize + name.size();
    at = entry.offset + entry.size;
    if (at > index_begin) return false;
    entries.push_back(std::move(entry));
  }
  return reader.ok() && reader.at_end() && at == index_begin;
}

/// Opens by the index. False where there is none, or none that can be trusted.
Result<bool> scan_index(const ReadAt& read_at, std::uint64_t size, SweepContents& contents) {
  if (size < kSweepHeadSize + kSweepTrailerSize) return false;
  std::array<std::byte, kSweepTrailerSize> trailer{};
  if (Status status = read_at(size - trailer.size(), trailer); !status) {
    return tl::unexpected(status.error());
  }
  ByteReader reader(trailer);
  const auto index_size = reader.get<std::uint32_t>();
  const auto crc = reader.get<std::uint32_t>();
  const auto end_magic = reader.get<std::uint64_t>();
  const std::uint64_t room = size - kSweepHeadSize - kSweepTrailerSize;
  if (end_magic != kTrailerMagic || index_size > std::min(room, kMaxIndexSize)) return false;
  std::vector<std::byte> index(index_size);
  const std::uint64_t index_begin = size - kSweepTrailerSize - index_size;
  if (Status status = read_at(index_begin, index); !status) return tl::unexpected(status.error());
  std::vector<SweepEntry> entries;
  if (crc32(index) != crc || !read_entries(index, index_begin, entries)) return false;
  contents = {std::move(entries), index_begin, SweepTail::index};
  return true;
}

/// Reads the head of the record at `contents.records_end`. Sets `tail` to `none` and gives an entry
/// where its frame is there as a whole, else sets `tail` to what stands there.
Result<SweepEntry> read_record_head(const ReadAt& read_at, std::uint64_t size, SweepTail& tail,
                                    std::uint64_t at) {
  std::array<std::byte, kRecordHeadSize + kMaxNameSize> buffer{};
  const auto head = std::span(buffer).first(
      static_cast<std::size_t>(std::min<std::uint64_t>(size - at, buffer.size())));
  if (Status status = read_at(at, head); !status) return tl::unexpected(status.error());
  ByteReader reader(head);
  SweepEntry entry;
  const auto frame_size = reader.get<std::uint32_t>();
  entry.name = reader.get_text();
  const bool all_there = reader.ok();
  const std::uint32_t crc = crc32(head.first(all_there ? reader.position() : 0));
  const bool sound =
      reader.get<std::uint32_t>() == crc && reader.ok() && frame_size <= kLargestFrame;
  entry.size = frame_size;
  entry.offset = at + reader.position();
  tail = SweepTail::none;
  if (sound) {
    if (size - entry.offset < entry.size) tail = SweepTail::cut;
    return entry;
  }
  const bool zeros =
      std::all_of(head.begin(), head.end(), [](std::byte b) { return b == std::byte{0}; });
  const bool began = !reader.ok() || frame_size == kIndexMarker || zeros;
  tail = began ? SweepTail::cut : SweepTail::damaged;
  return entry;
}

Status walk_records(const ReadAt& read_at, std::uint64_t size, SweepContents& contents) {
  contents = {{}, kSweepHeadSize, SweepTail::none};
  while (contents.records_end < size && contents.entries.size() < kMaxFrames) {
    auto entry = read_record_head(read_at, size, contents.tail, contents.records_end);
    if (!entry) return tl::unexpected(entry.error());
    if (contents.tail != SweepTail::none) break;
    contents.records_end = entry->offset + entry->size;
    contents.entries.push_back(std::move(*entry));
  }
  // A power loss may leave a file longer than what reached the disk.
  std::vector<std::byte> frame;
  while (!contents.entries.empty()) {
    const SweepEntry& last = contents.entries.back();
    frame.resize(static_cast<std::size_t>(last.size));
    if (Status status = read_at(last.offset, frame); !status) return status;
    if (check_frame(frame, true)) break;
    contents.records_end = last.offset - last.name.size() - kRecordHeadSize;
    contents.entries.pop_back();
    contents.tail = SweepTail::cut;
  }
  return {};
}

}  // namespace

void write_sweep_head(std::vector<std::byte>& out) {
  out.clear();
  ByteWriter writer(out);
  writer.put(kHeadMagic);
  writer.put(kVersion);
  writer.put(std::uint16_t{0});
  put_crc(out, 0);
}

void write_record_head(std::size_t frame_size, std::string_view name, std::vector<std::byte>& out) {
  out.clear();
  ByteWriter writer(out);
  writer.put(static_cast<std::uint32_t>(frame_size));
  writer.put_text(name);
  put_crc(out, 0);
}

void write_sweep_index(const std::vector<SweepEntry>& entries, std::vector<std::byte>& out) {
  out.clear();
  ByteWriter writer(out);
  writer.put(kIndexMarker);
  writer.put_varint(entries.size());
  std::string_view previous;
  for (const SweepEntry& entry : entries) {
    const std::size_t shared = shared_prefix(previous, entry.name);
    writer.put_varint(entry.size);
    writer.put(static_cast<std::uint8_t>(shared));
    writer.put_text(std::string_view(entry.name).substr(shared));
    previous = entry.name;
  }
  const auto index_size = static_cast<std::uint32_t>(out.size());
  const std::uint32_t crc = crc32(out);
  writer.put(index_size);
  writer.put(crc);
  writer.put(kTrailerMagic);
}

bool is_cut_head(std::span<const std::byte> bytes) {
  std::vector<std::byte> head;
  write_sweep_head(head);
  return bytes.size() < head.size() && std::equal(bytes.begin(), bytes.end(), head.begin());
}

Result<SweepContents> scan_sweep(const ReadAt& read_at, std::uint64_t size,
                                 const std::string& label) {
  if (Status status = check_head(read_at, size, label); !status)
    return tl::unexpected(status.error());
  SweepContents contents;
  const auto by_index = scan_index(read_at, size, contents);
  if (!by_index) return tl::unexpected(by_index.error());
  if (!*by_index) {
    if (Status status = walk_records(read_at, size, contents); !status) {
      return tl::unexpected(status.error());
    }
  }
  return contents;
}

Status check_frame(std::span<const std::byte> bytes, bool with_parts) {
  FrameHeader header;
  const Status status = parse_frame_header(bytes, header);
  // A frame of a newer version may be sound: whoever decodes it will know.
  if (!status && status.error().code == ErrorCode::unsupported) return {};
  if (!status) return fail(ErrorCode::invalid_argument, "not a frame: " + status.error().message);
  if (header.frame_size != bytes.size()) {
    return fail(ErrorCode::invalid_argument, "not one whole frame");
  }
  if (!with_parts) return {};
  for (const FramePart& part : header.parts) {
    const auto sound = checked_part(bytes, header, part.kind);
    if (!sound) return fail(ErrorCode::invalid_argument, sound.error().message);
  }
  return {};
}

}  // namespace sweepcast
