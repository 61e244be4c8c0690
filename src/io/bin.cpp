#include <array>
#include <string>
#include <string_view>

#include "io/formats.hpp"
#include "io/number_reader.hpp"
#include "io/record_table.hpp"

namespace sweepcast {
namespace {

constexpr std::size_t kPointSize = 16;

struct Kind {
  std::string_view begin;
  std::string_view name;
};

/// How files of other kinds begin that are easily taken for a .bin.
constexpr std::array<Kind, 7> kOtherKinds{{
    {"# .PCD", "a PCD file"},
    {"VERSION", "a PCD file"},
    {"ply\n", "a PLY file"},
    {"ply\r\n", "a PLY file"},
    {"SWEEPCST", "a .sweep file"},
    {"PK\x03\x04", "a zip archive"},
    {"\x1F\x8B\x08", "a gzip archive"},
}};

std::vector<RecordField> bin_fields() {
  return {{.name = "x", .column = CloudColumn::x},
          {.name = "y", .column = CloudColumn::y},
          {.name = "z", .column = CloudColumn::z},
          {.name = "intensity", .column = CloudColumn::intensity}};
}

}  // namespace

Status parse_bin(std::span<const std::byte> bytes, PointCloud& cloud) {
  if (bytes.empty()) return fail(ErrorCode::truncated, "is empty; copy or record it again");
  for (const auto& [begin, name] : kOtherKinds) {
    if (!as_text(bytes).starts_with(begin)) continue;
    return fail(ErrorCode::unsupported, "is not a KITTI .bin but " + std::string(name) +
                                            "; give it the extension of its kind");
  }
  if (bytes.size() % kPointSize != 0) {
    return fail(ErrorCode::truncated, "has " + std::to_string(bytes.size()) +
                                          " bytes, no multiple of 16 (x, y, z, intensity as "
                                          "float32); it was cut short or is no KITTI .bin");
  }
  NumberReader reader(bytes, NumberCoding::little_endian);
  return read_records(reader, bin_fields(), bytes.size() / kPointSize, cloud);
}

void serialize_bin(const PointCloud& cloud, std::vector<std::byte>& out) {
  out.clear();
  out.reserve(cloud.size() * kPointSize);
  write_records(cloud, bin_fields(), NumberCoding::little_endian, out);
}

}  // namespace sweepcast
