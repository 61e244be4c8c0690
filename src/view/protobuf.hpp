// Writing Protocol Buffers' wire format: tags, varints, fixed numbers, lengths.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/bytes.hpp"
#include "view/sweep.hpp"

namespace sweepcast::view {

/// Appends the fields of a message to a vector of bytes.
class ProtobufWriter {
 public:
  explicit ProtobufWriter(Bytes& out) : out_(out) {}

  ProtobufWriter& varint(std::uint32_t field, std::uint64_t value) {
    tag(field, 0);
    out_.put_varint(value);
    return *this;
  }
  ProtobufWriter& fixed32(std::uint32_t field, std::uint32_t value) {
    tag(field, 5);
    out_.put(value);
    return *this;
  }
  ProtobufWriter& real(std::uint32_t field, double value) {
    tag(field, 1);
    out_.put(std::bit_cast<std::uint64_t>(value));
    return *this;
  }
  ProtobufWriter& text(std::uint32_t field, std::string_view value) {
    return bytes(field, std::as_bytes(std::span(value)));
  }
  /// Bytes, or a message that was written before.
  ProtobufWriter& bytes(std::uint32_t field, std::span<const std::byte> value) {
    begin_bytes(field, value.size());
    out_.put_bytes(value);
    return *this;
  }
  /// The head of a field whose `size` bytes the caller appends.
  void begin_bytes(std::uint32_t field, std::size_t size) {
    tag(field, 2);
    out_.put_varint(size);
  }

 private:
  void tag(std::uint32_t field, std::uint32_t wire_type) {
    out_.put_varint(field << 3 | wire_type);
  }

  ByteWriter out_;
};

}  // namespace sweepcast::view
