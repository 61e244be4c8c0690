#include "common/recording.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/counts.hpp"

namespace sweepcast::app {

namespace {

bool is_control(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 0x20 || byte == 0x7F;
}

}  // namespace

bool is_plain_file_name(const std::string& name) {
  const auto is_harmful = [](char c) { return is_control(c) || c == '/' || c == '\\'; };
  return name != "." && name != ".." && std::none_of(name.begin(), name.end(), is_harmful);
}

Status check_complete(const std::filesystem::path& path, const SweepReader& reader) {
  if (!reader.was_cut()) return {};
  std::uint64_t end = 0;
  for (const SweepEntry& entry : reader.entries()) end = std::max(end, entry.offset + entry.size);
  if (end == reader.file_size()) return {};
  return fail(ErrorCode::truncated,
              fmt::format("{}: cut short or damaged behind its last whole frame: {} "
                          "read, what followed is lost; encode or fetch the rest again",
                          path.string(), count_of(reader.entries().size(), "whole frame")));
}

Status check_layered(const std::filesystem::path& path, SweepReader& reader,
                     const std::string& options) {
  std::vector<std::byte> frame;
  FrameHeader header;
  for (std::size_t i = 0; i < reader.entries().size(); ++i) {
    if (!reader.read(i, frame) || !parse_frame_header(frame, header)) continue;  // named later
    if (header.codec == CodecId::beam) return {};
    return fail(ErrorCode::invalid_argument,
                fmt::format("{}: is of codec {}, which has neither layers nor points to fill in; "
                            "leave {} out",
                            path.string(), name(header.codec), options));
  }
  return {};
}

std::string frame_error(const std::filesystem::path& path, const SweepReader& reader, std::size_t i,
                        const std::string& what) {
  const std::string& name = reader.entries()[i].name;
  const std::string known = name.empty() ? "" : fmt::format(" ({})", printable(name));
  return fmt::format("{}: frame {}{}: {}", path.string(), i, known, what);
}

std::string printable(std::string text) {
  std::replace_if(text.begin(), text.end(), is_control, '?');
  return text;
}

Result<std::string> source_name(const SweepEntry& entry, const FrameHeader& header) {
  if (!is_plain_file_name(entry.name)) {
    return fail(ErrorCode::corrupt,
                "its name is not a plain file name, so the file is damaged or was made to do "
                "harm; get it again from a source that you trust");
  }
  return entry.name.empty() ? fmt::format("{:06}", header.sequence) : entry.name;
}

Result<std::string> SweepNames::next(const SweepEntry& entry, const FrameHeader& header) {
  const auto base = source_name(entry, header);
  if (!base) return tl::unexpected(base.error());
  std::string name = *base;
  for (int i = 2; !used_.insert(name).second; ++i) name = fmt::format("{}-{}", *base, i);
  return name;
}

}  // namespace sweepcast::app
