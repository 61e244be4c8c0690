// The one checked way to read and write bytes. Little-endian, whatever the machine.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace sweepcast {

/// Appends to a vector of bytes.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::byte>& out) : out_(out) {}

  /// A fixed-width integer, least significant byte first.
  template <class Integer>
  void put(Integer value) {
    const auto bits = static_cast<std::make_unsigned_t<Integer>>(value);
    for (std::size_t i = 0; i < sizeof(Integer); ++i) {
      out_.push_back(static_cast<std::byte>(bits >> (8 * i)));
    }
  }

  /// An unsigned integer in groups of 7 bits, low group first (LEB128).
  void put_varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) out_.push_back(static_cast<std::byte>(value | 0x80));
    out_.push_back(static_cast<std::byte>(value));
  }

  /// A signed integer as a varint of its zigzag map: 0, -1, 1, -2, ... become 0, 1, 2, 3, ...
  void put_signed(std::int64_t value) {
    put_varint((static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63));
  }

  void put_bytes(std::span<const std::byte> bytes) {
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }

  /// A length as one byte, then that many bytes. The caller ensures at most 255.
  void put_text(std::string_view text) {
    put(static_cast<std::uint8_t>(text.size()));
    put_bytes(std::as_bytes(std::span(text.data(), text.size())));
  }

 private:
  std::vector<std::byte>& out_;
};

/// Reads what `ByteWriter` wrote, from bytes that nobody vouches for. Past the end, or on a value
/// that cannot be, it turns bad, stays bad, and gives zeros; so check `ok()` once after a group of
/// reads, and before any size that was read is used.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class Integer>
  [[nodiscard]] Integer get() {
    std::make_unsigned_t<Integer> bits = 0;
    if (!has(sizeof(Integer))) return 0;
    for (std::size_t i = 0; i < sizeof(Integer); ++i) {
      bits |= static_cast<std::make_unsigned_t<Integer>>(
          static_cast<std::make_unsigned_t<Integer>>(bytes_[at_ + i]) << (8 * i));
    }
    at_ += sizeof(Integer);
    return static_cast<Integer>(bits);
  }

  [[nodiscard]] std::uint64_t get_varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const auto byte = get<std::uint8_t>();
      value |= static_cast<std::uint64_t>(byte & 0x7F) << shift;
      if (byte < 0x80) {
        if (shift == 63 && byte > 1) ok_ = false;
        return ok_ ? value : 0;
      }
    }
    ok_ = false;
    return 0;
  }

  /// A varint that may be at most `cap`; a larger one turns the reader bad.
  [[nodiscard]] std::uint64_t get_varint(std::uint64_t cap) {
    const std::uint64_t value = get_varint();
    if (value > cap) ok_ = false;
    return ok_ ? value : 0;
  }

  [[nodiscard]] std::int64_t get_signed() {
    const std::uint64_t bits = get_varint();
    return static_cast<std::int64_t>((bits >> 1) ^ (~(bits & 1) + 1));
  }

  [[nodiscard]] std::span<const std::byte> get_bytes(std::size_t count) {
    if (!has(count)) return {};
    const auto part = bytes_.subspan(at_, count);
    at_ += count;
    return part;
  }

  [[nodiscard]] std::string_view get_text() {
    const auto part = get_bytes(get<std::uint8_t>());
    return {reinterpret_cast<const char*>(part.data()), part.size()};
  }

  [[nodiscard]] bool ok() const { return ok_; }
  /// Whether it was the end of the bytes that turned it bad, rather than a value.
  [[nodiscard]] bool ran_out() const { return ran_out_; }
  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }
  [[nodiscard]] std::size_t position() const { return at_; }
  [[nodiscard]] std::size_t remaining() const { return bytes_.size() - at_; }

 private:
  [[nodiscard]] bool has(std::size_t count) {
    if (ok_ && count > bytes_.size() - at_) {
      ok_ = false;
      ran_out_ = true;
    }
    return ok_;
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
  bool ran_out_ = false;
};

}  // namespace sweepcast
