#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "io/formats.hpp"
#include "io/record_table.hpp"
#include "io/text.hpp"

namespace sweepcast {
namespace {

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

struct TypeName {
  std::string_view name;
  NumberType type;
};

/// The names of the first writers of PLY, and those that tell the size.
constexpr std::array<TypeName, 18> kTypeNames{{
    {"char", NumberType::i8},
    {"uchar", NumberType::u8},
    {"short", NumberType::i16},
    {"ushort", NumberType::u16},
    {"int", NumberType::i32},
    {"uint", NumberType::u32},
    {"float", NumberType::f32},
    {"double", NumberType::f64},
    {"int8", NumberType::i8},
    {"uint8", NumberType::u8},
    {"int16", NumberType::i16},
    {"uint16", NumberType::u16},
    {"int32", NumberType::i32},
    {"uint32", NumberType::u32},
    {"int64", NumberType::i64},
    {"uint64", NumberType::u64},
    {"float32", NumberType::f32},
    {"float64", NumberType::f64},
}};

std::optional<NumberType> type_of(std::string_view name) {
  for (const TypeName& type : kTypeNames) {
    if (type.name == name) return type.type;
  }
  return std::nullopt;
}

std::string_view name_of(NumberType type) {
  for (const TypeName& name : kTypeNames) {
    if (name.type == type) return name.name;
  }
  return {};
}

/// Takes "format CODING VERSION" after its keyword.
bool take_format(std::string_view line, PlyHeader& header) {
  const std::string_view coding = next_word(line);
  if (coding == "ascii") header.coding = NumberCoding::text;
  if (coding == "binary_little_endian") header.coding = NumberCoding::little_endian;
  if (coding == "binary_big_endian") header.coding = NumberCoding::big_endian;
  return header.coding.has_value() && next_word(line) == "1.0";
}

/// Takes "element NAME COUNT" after its keyword.
bool take_element(std::string_view line, PlyHeader& header) {
  PlyElement element;
  element.name = next_word(line);
  const auto count = number_of<std::uint64_t>(next_word(line));
  if (!count || header.elements.size() == kMaxFields) return false;
  element.count = *count;
  header.elements.push_back(std::move(element));
  return true;
}

/// Takes "property TYPE NAME" or "property list COUNT_TYPE TYPE NAME" after its keyword.
bool take_property(std::string_view line, PlyHeader& header) {
  if (header.elements.empty() || header.elements.back().fields.size() == kMaxFields) return false;
  RecordField field;
  std::string_view word = next_word(line);
  if (word == "list") {
    field.list_count = type_of(next_word(line));
    if (!field.list_count || is_real(*field.list_count)) return false;
    word = next_word(line);
  }
  const auto type = type_of(word);
  field.name = next_word(line);
  if (!type || field.name.empty()) return false;
  field.type = *type;
  header.elements.back().fields.push_back(std::move(field));
  return true;
}

/// Takes one line of the header. False where it cannot be one.
bool take_line(std::string_view line, PlyHeader& header) {
  const std::string_view keyword = next_word(line);
  if (keyword == "format") return take_format(line, header);
  if (keyword == "element") return take_element(line, header);
  if (keyword == "property") return take_property(line, header);
  return keyword == "comment" || keyword == "obj_info" || keyword.empty();
}

Status parse_header(std::span<const std::byte> bytes, PlyHeader& header) {
  LineReader lines(as_text(bytes));
  if (lines.next() != "ply") {
    return fail(ErrorCode::unsupported, "is not a PLY file; give it the extension of its kind");
  }
  while (true) {
    const auto line = lines.next();
    if (!line) return fail(ErrorCode::truncated, "ends within the PLY header; copy it again");
    std::string_view rest = *line;
    if (next_word(rest) == "end_header") break;
    if (take_line(*line, header)) continue;
    return fail(ErrorCode::corrupt, "line " + std::to_string(lines.line()) +
                                        " of the header: not an entry of a PLY 1.0 header; write "
                                        "the file again");
  }
  if (!header.coding) {
    return fail(ErrorCode::corrupt, "the header has no line 'format'; write the file again");
  }
  header.lines = lines.line();
  header.size = bytes.size() - lines.rest().size();
  return {};
}

}  // namespace

Status parse_ply(std::span<const std::byte> bytes, PointCloud& cloud,
                 std::vector<std::string>* skipped) {
  if (bytes.empty()) return fail(ErrorCode::truncated, "is empty; copy or record it again");
  PlyHeader header;
  if (Status status = parse_header(bytes, header); !status) return status;
  NumberReader reader(bytes.subspan(header.size), *header.coding, header.lines);
  for (PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      if (Status status = assign_columns(element.fields); !status) return status;
      if (skipped != nullptr) *skipped = names_of_skipped(element.fields);
      return read_records(reader, element.fields, element.count, cloud);
    }
    if (Status status = skip_records(reader, element.fields, element.count); !status) return status;
  }
  return fail(ErrorCode::unsupported, "has no element 'vertex'; it is not a point cloud");
}

void serialize_ply(const PointCloud& cloud, CloudEncoding encoding, std::vector<std::byte>& out) {
  out.clear();
  const bool text = encoding == CloudEncoding::ascii;
  const std::vector<RecordField> fields = fields_of(cloud);
  std::string header = "ply\nformat ";
  header += text ? "ascii" : "binary_little_endian";
  header += " 1.0\nelement vertex " + std::to_string(cloud.size()) + "\n";
  for (const RecordField& field : fields) {
    (header += "property ") += name_of(field.type);
    header += " " + field.name + "\n";
  }
  append_text(header + "end_header\n", out);
  write_records(cloud, fields, text ? NumberCoding::text : NumberCoding::little_endian, out);
}

}  // namespace sweepcast
