#include "io/number_reader.hpp"

#include <bit>
#include <limits>
#include <utility>

namespace sweepcast {
namespace {

/// Bytes as an unsigned integer of a width that the compiler knows: it makes one load of the loop.
template <class Bits>
std::uint64_t load(const std::byte* bytes, bool big_endian) {
  Bits little = 0;
  Bits big = 0;
  for (std::size_t i = 0; i < sizeof(Bits); ++i) {
    little = static_cast<Bits>(little | static_cast<Bits>(bytes[i]) << (8 * i));
    big = static_cast<Bits>(big | static_cast<Bits>(bytes[sizeof(Bits) - 1 - i]) << (8 * i));
  }
  return big_endian ? big : little;
}

std::uint64_t load_bits(std::span<const std::byte> bytes, NumberCoding coding) {
  const bool big_endian = coding == NumberCoding::big_endian;
  switch (bytes.size()) {
    case 1:
      return load<std::uint8_t>(bytes.data(), big_endian);
    case 2:
      return load<std::uint16_t>(bytes.data(), big_endian);
    case 4:
      return load<std::uint32_t>(bytes.data(), big_endian);
    default:
      return load<std::uint64_t>(bytes.data(), big_endian);
  }
}

/// Two's complement of the type's width.
template <class Signed>
Number signed_number(std::uint64_t bits) {
  const auto value = static_cast<Signed>(static_cast<std::make_unsigned_t<Signed>>(bits));
  return {static_cast<double>(value), value};
}

Number unsigned_number(std::uint64_t bits) {
  return {static_cast<double>(bits), static_cast<std::int64_t>(bits)};
}

std::optional<Number> real_from_text(std::string_view word, NumberType type) {
  if (type == NumberType::f32) {
    // By way of a double, some decimals would be rounded twice.
    if (const auto value = number_of<float>(word)) return Number{*value, 0};
  }
  // Also what is too large or too small for a float: it becomes infinite or zero.
  if (const auto value = number_of<double>(word)) return Number{*value, 0};
  return std::nullopt;
}

}  // namespace

std::size_t size_of(NumberType type) noexcept {
  switch (type) {
    case NumberType::i8:
    case NumberType::u8:
      return 1;
    case NumberType::i16:
    case NumberType::u16:
      return 2;
    case NumberType::i32:
    case NumberType::u32:
    case NumberType::f32:
      return 4;
    case NumberType::i64:
    case NumberType::u64:
    case NumberType::f64:
      return 8;
  }
  return 8;
}

NumberReader::NumberReader(std::span<const std::byte> bytes, NumberCoding coding, std::size_t line)
    : coding_(coding), lines_(as_text(bytes), line), bytes_(bytes) {}

void NumberReader::begin_record() {
  if (coding_ != NumberCoding::text || !ok()) return;
  while (const auto line = lines_.next()) {
    line_ = *line;
    std::string_view rest = line_;
    if (!next_word(rest).empty()) return;
  }
  line_ = {};
  stop(ErrorCode::truncated, "the text ends here");
}

void NumberReader::end_record() {
  if (coding_ != NumberCoding::text || !ok()) return;
  if (!next_word(line_).empty()) refuse("more numbers than the header announces");
}

bool NumberReader::skip_line() {
  if (coding_ != NumberCoding::text) return false;
  begin_record();
  return true;
}

Number NumberReader::get(NumberType type) {
  if (!ok()) return {};
  return coding_ == NumberCoding::text ? get_text(type) : get_binary(type);
}

void NumberReader::skip(NumberType type, std::uint64_t count) {
  if (!ok()) return;
  if (coding_ == NumberCoding::text) {
    for (; count > 0 && ok(); --count) {
      if (next_word(line_).empty()) refuse("fewer numbers than the header announces");
    }
    return;
  }
  if (count > remaining() / size_of(type)) return stop(ErrorCode::truncated, "the data ends here");
  at_ += static_cast<std::size_t>(count) * size_of(type);
}

std::size_t NumberReader::remaining() const {
  return coding_ == NumberCoding::text ? lines_.rest().size() : bytes_.size() - at_;
}

bool NumberReader::only_blanks_follow() const {
  return lines_.rest().find_first_not_of(" \t\v\f\r\n") == std::string_view::npos;
}

Number NumberReader::get_text(NumberType type) {
  const std::string_view word = next_word(line_);
  if (word.empty()) {
    refuse("fewer numbers than the header announces");
    return {};
  }
  if (is_real(type)) {
    if (const auto number = real_from_text(word, type)) return *number;
  } else if (const auto value = number_of<std::int64_t>(word)) {
    return {static_cast<double>(*value), *value};
  }
  constexpr std::size_t kQuoted = 40;
  std::string what = "'";
  what += word.substr(0, kQuoted);
  what += is_real(type) ? "' is not a number" : "' is not an integer";
  refuse(std::move(what));
  return {};
}

Number NumberReader::get_binary(NumberType type) {
  const std::size_t size = size_of(type);
  if (size > remaining()) {
    stop(ErrorCode::truncated, "the data ends here");
    return {};
  }
  const std::uint64_t bits = load_bits(bytes_.subspan(at_, size), coding_);
  at_ += size;
  switch (type) {
    case NumberType::i8:
      return signed_number<std::int8_t>(bits);
    case NumberType::i16:
      return signed_number<std::int16_t>(bits);
    case NumberType::i32:
      return signed_number<std::int32_t>(bits);
    case NumberType::i64:
      return signed_number<std::int64_t>(bits);
    case NumberType::f32:
      return {std::bit_cast<float>(static_cast<std::uint32_t>(bits)), 0};
    case NumberType::f64:
      return {std::bit_cast<double>(bits), 0};
    default:
      break;
  }
  if (bits > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
    refuse("an integer above 2^63 - 1");
    return {};
  }
  return unsigned_number(bits);
}

void NumberReader::stop(ErrorCode code, std::string what) {
  if (error_) return;
  const std::string where = coding_ == NumberCoding::text
                                ? "line " + std::to_string(lines_.line())
                                : "byte " + std::to_string(at_) + " of the data";
  error_ = Error{code, where + ": " + std::move(what)};
}

}  // namespace sweepcast
