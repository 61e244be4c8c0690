// Takes the place of codec/entropy/zstd_coder.cpp: zstd is not among what can be had for
// WebAssembly, so the page lends its own, which unpacks one whole frame (src/wasm_decoder.ts).
#include "codec/entropy/zstd_coder.hpp"
#include "core/bytes.hpp"

extern "C" {
/// Unpacks the zstd frame without magic number at `packed` into the `raw_size` bytes at `raw`.
/// Returns how many bytes it became, or -1.
[[clang::import_module("page"), clang::import_name("unpack_zstd")]] int page_unpack_zstd(
    const void* packed, unsigned packed_size, void* raw, unsigned raw_size);
}

namespace sweepcast {

void ZstdEncoder::Free::operator()(void* /*context*/) const {}
void ZstdDecoder::Free::operator()(void* /*context*/) const {}

ZstdEncoder::ZstdEncoder(int /*level*/) {}
ZstdDecoder::ZstdDecoder() = default;

// The page never encodes; the linker wants it all the same.
void ZstdEncoder::append(std::span<const std::byte> /*raw*/, std::vector<std::byte>& /*out*/) {}

Status ZstdDecoder::decode(std::span<const std::byte> packed, std::size_t max_size,
                           std::vector<std::byte>& raw) {
  raw.clear();
  ByteReader reader(packed);
  const std::uint64_t size = reader.get_varint();
  if (!reader.ok()) return fail(ErrorCode::corrupt, "a part of the frame has no size");
  if (size > max_size) return fail(ErrorCode::limit, "a part of the frame is larger than its cap");
  if (size == 0) return {};
  const auto body = reader.get_bytes(reader.remaining());
  raw.resize(size);
  const int got = page_unpack_zstd(body.data(), static_cast<unsigned>(body.size()), raw.data(),
                                   static_cast<unsigned>(raw.size()));
  if (got < 0 || static_cast<std::uint64_t>(got) != size) {
    raw.clear();
    return fail(ErrorCode::corrupt, "a part of the frame does not unpack");
  }
  return {};
}

}  // namespace sweepcast
