#include <lzf.h>

#include <array>
#include <string>
#include <string_view>

#include "core/bytes.hpp"
#include "io/formats.hpp"
#include "io/record_table.hpp"
#include "io/text.hpp"

namespace sweepcast {
namespace {

/// What the header of a PCD says.
struct PcdHeader {
  std::vector<RecordField> fields;
  std::uint64_t points = 0;
  std::uint32_t width = 0;  ///< of an organised cloud, else 0
  CloudEncoding encoding = CloudEncoding::ascii;
  std::size_t size = 0;   ///< bytes of the header
  std::size_t lines = 0;  ///< lines of the header
};

/// The header's entries as they stand, by keyword.
struct PcdEntries {
  std::vector<std::string_view> fields, sizes, types, counts;
  std::optional<std::uint64_t> width, height, points;
  std::string_view data;
};

struct TypeName {
  std::string_view kind;
  std::string_view size;
  NumberType type;
};

constexpr std::array<TypeName, 10> kTypeNames{{
    {"I", "1", NumberType::i8},
    {"U", "1", NumberType::u8},
    {"I", "2", NumberType::i16},
    {"U", "2", NumberType::u16},
    {"I", "4", NumberType::i32},
    {"U", "4", NumberType::u32},
    {"I", "8", NumberType::i64},
    {"U", "8", NumberType::u64},
    {"F", "4", NumberType::f32},
    {"F", "8", NumberType::f64},
}};

std::optional<NumberType> type_of(std::string_view kind, std::string_view size) {
  for (const TypeName& name : kTypeNames) {
    if (name.kind == kind && name.size == size) return name.type;
  }
  return std::nullopt;
}

const TypeName& name_of(NumberType type) {
  return kTypeNames[static_cast<std::size_t>(type)];
}

Status bad_line(std::size_t line, const std::string& what) {
  return fail(ErrorCode::corrupt, "line " + std::to_string(line) + " of the header: " + what +
                                      "; write the file again");
}

/// Takes one line of the header. False where its keyword or its number is unknown.
bool take_line(std::string_view line, PcdEntries& entries) {
  const std::string_view keyword = next_word(line);
  const auto number = [&] { return number_of<std::uint64_t>(next_word(line)); };
  if (keyword == "FIELDS" || keyword == "COLUMNS") {
    entries.fields = words_of(line);
  } else if (keyword == "SIZE") {
    entries.sizes = words_of(line);
  } else if (keyword == "TYPE") {
    entries.types = words_of(line);
  } else if (keyword == "COUNT") {
    entries.counts = words_of(line);
  } else if (keyword == "WIDTH") {
    return (entries.width = number()).has_value();
  } else if (keyword == "HEIGHT") {
    return (entries.height = number()).has_value();
  } else if (keyword == "POINTS") {
    return (entries.points = number()).has_value();
  } else if (keyword == "DATA") {
    entries.data = next_word(line);
  } else {
    return keyword == "VERSION" || keyword == "VIEWPOINT";
  }
  return true;
}

Status resolve_points(const PcdEntries& entries, PcdHeader& header) {
  if (!entries.width && !entries.points) {
    return fail(ErrorCode::corrupt,
                "the header has neither WIDTH nor POINTS; write the file again");
  }
  const std::uint64_t height = entries.height.value_or(1);
  const std::uint64_t width = entries.width ? *entries.width : *entries.points;
  if (height > kMaxPoints || width > kMaxPoints) {
    return fail(ErrorCode::limit,
                "announces more than " + std::to_string(kMaxPoints) + " points; split the cloud");
  }
  header.points = entries.points.value_or(width * height);
  if (!entries.width || header.points == width * height) {
    if (height > 1) header.width = static_cast<std::uint32_t>(width);
    return {};
  }
  return fail(ErrorCode::corrupt, "the header announces " + std::to_string(width) + " x " +
                                      std::to_string(height) + " points, and " +
                                      std::to_string(header.points) +
                                      " as their number; write the file again");
}

Status resolve_fields(const PcdEntries& entries, PcdHeader& header) {
  const std::size_t count = entries.fields.size();
  const bool has_counts = !entries.counts.empty();
  if (count == 0 || count > kMaxFields || entries.sizes.size() != count ||
      entries.types.size() != count || (has_counts && entries.counts.size() != count)) {
    return fail(ErrorCode::corrupt,
                "FIELDS, SIZE, TYPE and COUNT of the header do not have an entry for each field; "
                "write the file again");
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::string name(entries.fields[i]);
    const auto type = type_of(entries.types[i], entries.sizes[i]);
    const auto numbers =
        has_counts ? number_of<std::uint64_t>(entries.counts[i]) : std::uint64_t{1};
    if (!type || !numbers || *numbers == 0 || *numbers > kMaxFields) {
      return fail(ErrorCode::corrupt, "the field '" + name +
                                          "' has a SIZE, TYPE or COUNT that cannot be; write the "
                                          "file again");
    }
    header.fields.push_back({.name = name, .type = *type, .count = *numbers});
  }
  return assign_columns(header.fields);
}

Status resolve_encoding(std::string_view data, PcdHeader& header) {
  if (data == "ascii") {
    header.encoding = CloudEncoding::ascii;
  } else if (data == "binary") {
    header.encoding = CloudEncoding::binary;
  } else if (data == "binary_compressed") {
    header.encoding = CloudEncoding::binary_compressed;
  } else {
    return fail(ErrorCode::unsupported,
                "DATA is neither ascii, binary nor binary_compressed; write the file again");
  }
  return {};
}

Status parse_header(std::span<const std::byte> bytes, PcdHeader& header) {
  LineReader lines(as_text(bytes));
  PcdEntries entries;
  bool begun = false;
  while (entries.data.empty()) {
    const auto line = lines.next();
    if (!line) return fail(ErrorCode::truncated, "ends within the PCD header; copy it again");
    std::string_view rest = *line;
    const std::string_view keyword = next_word(rest);
    if (keyword.empty() || keyword.front() == '#') continue;
    if (!take_line(*line, entries)) {
      if (begun) return bad_line(lines.line(), "not an entry of a PCD header");
      return fail(ErrorCode::unsupported, "is not a PCD file; give it the extension of its kind");
    }
    begun = true;
  }
  header.lines = lines.line();
  header.size = bytes.size() - lines.rest().size();
  if (Status status = resolve_encoding(entries.data, header); !status) return status;
  if (Status status = resolve_points(entries, header); !status) return status;
  return resolve_fields(entries, header);
}

/// The part that `binary_compressed` has in place of records: its compressed and its whole size,
/// then the fields' columns, LZF-compressed. Errors: truncated, corrupt.
Status expand(std::span<const std::byte> bytes, std::uint64_t expected,
              std::vector<std::byte>& columns) {
  ByteReader reader(bytes);
  const auto compressed_size = reader.get<std::uint32_t>();
  const auto size = reader.get<std::uint32_t>();
  const auto compressed = reader.get_bytes(compressed_size);
  if (!reader.ok()) {
    return fail(ErrorCode::truncated, "the compressed data is cut short; copy the file again");
  }
  if (size != expected) {
    return fail(ErrorCode::corrupt, "the compressed data announces " + std::to_string(size) +
                                        " bytes where the points take " + std::to_string(expected) +
                                        "; copy the file again");
  }
  constexpr std::uint64_t kBestRatio = 264;  // LZF's longest match, by far, for two bytes of code
  if (size > kBestRatio * compressed_size) {
    return fail(ErrorCode::corrupt, "the compressed data has " + std::to_string(compressed_size) +
                                        " bytes, too few for the " + std::to_string(size) +
                                        " that it announces; copy the file again");
  }
  columns.resize(size);
  if (size == 0) return {};
  if (lzf_decompress(compressed.data(), compressed_size, columns.data(), size) == size) return {};
  return fail(ErrorCode::corrupt, "the compressed data is damaged; copy the file again");
}

void write_header(const PointCloud& cloud, const std::vector<RecordField>& fields,
                  std::string_view data, std::vector<std::byte>& out) {
  std::string names, sizes, types, counts;
  for (const RecordField& field : fields) {
    names += " " + field.name;
    (sizes += " ") += name_of(field.type).size;
    (types += " ") += name_of(field.type).kind;
    counts += " 1";
  }
  const std::string points = std::to_string(cloud.size());
  const bool organised = cloud.width > 0 && cloud.size() % cloud.width == 0;
  const std::string width = organised ? std::to_string(cloud.width) : points;
  const std::string height = organised ? std::to_string(cloud.size() / cloud.width) : "1";
  append_text("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS" + names + "\nSIZE" +
                  sizes + "\nTYPE" + types + "\nCOUNT" + counts + "\nWIDTH " + width + "\nHEIGHT " +
                  height + "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + points + "\nDATA ",
              out);
  append_text(data, out);
  append_text("\n", out);
}

void write_compressed(const PointCloud& cloud, const std::vector<RecordField>& fields,
                      std::vector<std::byte>& out) {
  std::vector<std::byte> columns;
  write_columns(cloud, fields, columns);
  // What does not compress grows by one byte in 32.
  std::vector<std::byte> compressed(columns.size() + columns.size() / 16 + 64);
  const auto size = static_cast<unsigned>(columns.size());
  const unsigned compressed_size = columns.empty()
                                       ? 0
                                       : lzf_compress(columns.data(), size, compressed.data(),
                                                      static_cast<unsigned>(compressed.size()));
  compressed.resize(compressed_size);
  ByteWriter writer(out);
  writer.put(static_cast<std::uint32_t>(compressed_size));
  writer.put(static_cast<std::uint32_t>(size));
  writer.put_bytes(compressed);
}

Status parse_points(std::span<const std::byte> bytes, const PcdHeader& header, PointCloud& cloud) {
  const auto data = bytes.subspan(header.size);
  if (header.encoding == CloudEncoding::ascii) {
    NumberReader reader(data, NumberCoding::text, header.lines);
    Status status = read_records(reader, header.fields, header.points, cloud);
    if (!status || reader.only_blanks_follow()) return status;
    return fail(ErrorCode::corrupt, "holds more points than its header announces; correct POINTS");
  }
  if (header.encoding == CloudEncoding::binary) {
    NumberReader reader(data, NumberCoding::little_endian);
    return read_records(reader, header.fields, header.points, cloud);
  }
  std::vector<std::byte> columns;
  const std::uint64_t size = header.points * record_size(header.fields);
  if (Status status = expand(data, size, columns); !status) return status;
  NumberReader reader(columns, NumberCoding::little_endian);
  return read_columns(reader, header.fields, header.points, cloud);
}

}  // namespace

Status parse_pcd(std::span<const std::byte> bytes, PointCloud& cloud,
                 std::vector<std::string>* skipped) {
  if (bytes.empty()) return fail(ErrorCode::truncated, "is empty; copy or record it again");
  PcdHeader header;
  if (Status status = parse_header(bytes, header); !status) return status;
  if (skipped != nullptr) *skipped = names_of_skipped(header.fields);
  Status status = parse_points(bytes, header, cloud);
  cloud.width = status ? header.width : 0;
  return status;
}

void serialize_pcd(const PointCloud& cloud, CloudEncoding encoding, std::vector<std::byte>& out) {
  out.clear();
  const std::vector<RecordField> fields = fields_of(cloud);
  switch (encoding) {
    case CloudEncoding::ascii:
      write_header(cloud, fields, "ascii", out);
      return write_records(cloud, fields, NumberCoding::text, out);
    case CloudEncoding::binary:
      write_header(cloud, fields, "binary", out);
      return write_records(cloud, fields, NumberCoding::little_endian, out);
    case CloudEncoding::binary_compressed:
      write_header(cloud, fields, "binary_compressed", out);
      return write_compressed(cloud, fields, out);
  }
}

}  // namespace sweepcast
