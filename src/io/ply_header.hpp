// The header of a PLY file: which records follow, and how their numbers stand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "io/record_table.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast {

/// A table of the file, named in the bytes of its header.
struct PlyElement {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<RecordField> fields;
};

/// What the header of a PLY says.
struct PlyHeader {
  std::vector<PlyElement> elements;
  std::optional<NumberCoding> coding;
  std::size_t size = 0;   ///< bytes of the header
  std::size_t lines = 0;  ///< lines of the header
};

/// Reads a header. Errors: unsupported (no PLY), truncated, corrupt; messages lack the file's name.
[[nodiscard]] Status parse_ply_header(std::span<const std::byte> bytes, PlyHeader& header);

/// PLY's own name of a number type.
[[nodiscard]] std::string_view ply_name_of(NumberType type);

}  // namespace sweepcast
