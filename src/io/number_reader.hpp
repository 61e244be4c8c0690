// Numbers of a declared type, one after the other, from text or from bytes that nobody vouches for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "io/text.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast {

/// The number types of PCD and PLY.
enum class NumberType : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

/// Bytes that a number of this type takes in a binary file.
[[nodiscard]] std::size_t size_of(NumberType type) noexcept;
[[nodiscard]] constexpr bool is_real(NumberType type) noexcept {
  return type >= NumberType::f32;
}

/// How numbers stand in a file.
enum class NumberCoding : std::uint8_t { text, little_endian, big_endian };

/// A number that was read; `integer` is exact for integer types and 0 for the others.
struct Number {
  double real = 0.0;
  std::int64_t integer = 0;
};

/// Reads records of numbers. In text, a record is a line; blank lines do not count. On a number
/// that cannot be read it turns bad, stays bad and gives zeros; `error` then says why and where.
class NumberReader {
 public:
  /// `bytes` begin after the header, whose last line has number `line`.
  NumberReader(std::span<const std::byte> bytes, NumberCoding coding, std::size_t line = 0);

  void begin_record();
  /// In text, what is left of the line must be blank.
  void end_record();
  /// Passes over a whole record in text; does nothing to bytes.
  [[nodiscard]] bool skip_line();

  [[nodiscard]] Number get(NumberType type);
  void skip(NumberType type, std::uint64_t count);

  /// Bytes of text or binary numbers not yet read.
  [[nodiscard]] std::size_t remaining() const;
  /// In text, whether only blank lines follow.
  [[nodiscard]] bool only_blanks_follow() const;
  [[nodiscard]] NumberCoding coding() const { return coding_; }
  [[nodiscard]] bool ok() const { return !error_; }
  [[nodiscard]] const Error& error() const { return *error_; }
  /// Turns the reader bad, for a value that its caller cannot accept.
  void refuse(std::string what) { stop(ErrorCode::corrupt, std::move(what)); }

 private:
  [[nodiscard]] Number get_text(NumberType type);
  [[nodiscard]] Number get_binary(NumberType type);
  void stop(ErrorCode code, std::string what);

  NumberCoding coding_;
  std::optional<Error> error_;
  LineReader lines_;                  // text
  std::string_view line_;             // text: what is left of the record
  std::span<const std::byte> bytes_;  // binary
  std::size_t at_ = 0;                // binary
};

}  // namespace sweepcast
