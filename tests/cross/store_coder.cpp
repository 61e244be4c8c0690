// Takes the place of codec/entropy/zstd_coder.cpp where there is no zstd for the processor at hand:
// parts are stored as they are. What codec `rcpcc` computes is then compared all the same.
#include "codec/entropy/zstd_coder.hpp"
#include "core/bytes.hpp"

namespace sweepcast {

void ZstdEncoder::Free::operator()(void* /*context*/) const {}
void ZstdDecoder::Free::operator()(void* /*context*/) const {}

ZstdEncoder::ZstdEncoder(int /*level*/) {}
ZstdDecoder::ZstdDecoder() = default;

void ZstdEncoder::append(std::span<const std::byte> raw, std::vector<std::byte>& out) {
  ByteWriter writer(out);
  writer.put_varint(raw.size());
  writer.put_bytes(raw);
}

Status ZstdDecoder::decode(std::span<const std::byte> packed, std::size_t max_size,
                           std::vector<std::byte>& raw) {
  ByteReader reader(packed);
  const std::uint64_t size = reader.get_varint(max_size);
  const auto bytes = reader.get_bytes(reader.remaining());
  if (!reader.ok() || bytes.size() != size) return fail(ErrorCode::corrupt, "a part is damaged");
  raw.assign(bytes.begin(), bytes.end());
  return {};
}

}  // namespace sweepcast
