#include "codec/entropy/zstd_coder.hpp"

#define ZSTD_STATIC_LINKING_ONLY  // for ZSTD_c_format: frames without magic number
#include <zstd.h>

#include "core/bytes.hpp"

namespace sweepcast {
namespace {

ZSTD_CCtx* encoder(void* context) {
  return static_cast<ZSTD_CCtx*>(context);
}
ZSTD_DCtx* decoder(void* context) {
  return static_cast<ZSTD_DCtx*>(context);
}

}  // namespace

void ZstdEncoder::Free::operator()(void* context) const {
  ZSTD_freeCCtx(encoder(context));
}

ZstdEncoder::ZstdEncoder(int level) : context_(ZSTD_createCCtx()) {
  ZSTD_CCtx* context = encoder(context_.get());
  ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, level);
  ZSTD_CCtx_setParameter(context, ZSTD_c_contentSizeFlag, 0);
  ZSTD_CCtx_setParameter(context, ZSTD_c_format, ZSTD_f_zstd1_magicless);
}

void ZstdEncoder::append(std::span<const std::byte> raw, std::vector<std::byte>& out) {
  ByteWriter(out).put_varint(raw.size());
  if (raw.empty()) return;
  const std::size_t begin = out.size();
  out.resize(begin + ZSTD_compressBound(raw.size()));
  const std::size_t size = ZSTD_compress2(encoder(context_.get()), out.data() + begin,
                                          out.size() - begin, raw.data(), raw.size());
  // With room for the bound, ZSTD_compress2 can fail only for want of memory.
  out.resize(begin + (ZSTD_isError(size) != 0 ? 0 : size));
}

void ZstdDecoder::Free::operator()(void* context) const {
  ZSTD_freeDCtx(decoder(context));
}

ZstdDecoder::ZstdDecoder() : context_(ZSTD_createDCtx()) {
  ZSTD_DCtx_setParameter(decoder(context_.get()), ZSTD_d_format, ZSTD_f_zstd1_magicless);
}

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
  const std::size_t got = ZSTD_decompressDCtx(decoder(context_.get()), raw.data(), raw.size(),
                                              body.data(), body.size());
  if (ZSTD_isError(got) != 0 || got != size) {
    raw.clear();
    return fail(ErrorCode::corrupt, "a part of the frame does not unpack");
  }
  return {};
}

}  // namespace sweepcast
