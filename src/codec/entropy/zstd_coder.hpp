// zstd around a buffer, with contexts and buffers that are kept.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "sweepcast/status.hpp"

namespace sweepcast {

/// Compresses parts of frames: varint of the raw size, then one zstd frame without magic number,
/// content size and checksum, which the frame around it makes superfluous.
class ZstdEncoder {
 public:
  explicit ZstdEncoder(int level);

  /// Appends the packed form of `raw` to `out`.
  void append(std::span<const std::byte> raw, std::vector<std::byte>& out);

 private:
  struct Free {
    void operator()(void* context) const;
  };
  std::unique_ptr<void, Free> context_;
};

/// The inverse of `ZstdEncoder`.
class ZstdDecoder {
 public:
  ZstdDecoder();

  /// Fills `raw`, whose memory is reused. Errors: corrupt, limit (over `max_size` bytes announced).
  [[nodiscard]] Status decode(std::span<const std::byte> packed, std::size_t max_size,
                              std::vector<std::byte>& raw);

 private:
  struct Free {
    void operator()(void* context) const;
  };
  std::unique_ptr<void, Free> context_;
};

}  // namespace sweepcast
