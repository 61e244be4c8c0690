#include <algorithm>
#include <array>
#include <cmath>
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

bool is_text(std::span<const std::byte> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte byte) {
    const auto c = static_cast<unsigned char>(byte);
    return (c >= ' ' && c <= '~') || c == '\t' || c == '\n' || c == '\r';
  });
}

/// Whether most coordinates are farther than the Earth's other pole, or smaller than the rounding
/// of a sine leaves and not zero: bytes of another meaning, seen as float32, have any order of
/// magnitude. NaN and infinity say nothing, since sensors write them too.
bool is_implausible(const PointCloud& cloud) {
  constexpr float kNearest = 1e-18F;
  constexpr float kFarthest = 2e7F;
  std::size_t wild = 0;
  for (const auto* column : {&cloud.x, &cloud.y, &cloud.z}) {
    for (const float value : *column) {
      const float size = std::abs(value);
      if (std::isfinite(size) && size != 0.0F && (size < kNearest || size > kFarthest)) ++wild;
    }
  }
  return wild > 3 * cloud.size() / 2;
}

Status refuse(const std::string& what) {
  return fail(ErrorCode::unsupported,
              what +
                  ", and a KITTI .bin holds x, y, z, intensity as little-endian float32, in "
                  "metres; name a file of that kind");
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
  if (is_text(bytes)) return refuse("is text");
  NumberReader reader(bytes, NumberCoding::little_endian);
  const std::size_t count = bytes.size() / kPointSize;
  if (Status read = read_records(reader, bin_fields(), count, cloud); !read) return read;
  if (is_implausible(cloud)) return refuse("holds numbers that cannot be coordinates");
  return {};
}

void serialize_bin(const PointCloud& cloud, std::vector<std::byte>& out) {
  out.clear();
  out.reserve(cloud.size() * kPointSize);
  write_records(cloud, bin_fields(), NumberCoding::little_endian, out);
}

}  // namespace sweepcast
