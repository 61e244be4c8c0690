#include "io/ply_header.hpp"

#include <array>
#include <string>
#include <utility>

#include "io/text.hpp"

namespace sweepcast {
namespace {

struct PlyTypeName {
  std::string_view name;
  NumberType type;
};

/// The names of the first writers of PLY, and those that tell the size.
constexpr std::array<PlyTypeName, 18> kPlyTypeNames{{
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
  for (const PlyTypeName& type : kPlyTypeNames) {
    if (type.name == name) return type.type;
  }
  return std::nullopt;
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

}  // namespace

Status parse_ply_header(std::span<const std::byte> bytes, PlyHeader& header) {
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

std::string_view ply_name_of(NumberType type) {
  for (const PlyTypeName& name : kPlyTypeNames) {
    if (name.type == type) return name.name;
  }
  return {};
}

}  // namespace sweepcast
