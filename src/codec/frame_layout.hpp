// Writing a frame: its head, and the parts that a codec fills. Reading the head is public:
// `parse_frame_header` in sweepcast/frame.hpp. docs/format.md has the bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/bytes.hpp"
#include "sweepcast/frame.hpp"

namespace sweepcast {

inline constexpr std::uint32_t kFrameMagic = 0x46505753;  // "SWPF"
inline constexpr std::uint8_t kFrameVersion = 1;
inline constexpr std::size_t kLargestFrame = std::size_t{256} << 20;
inline constexpr std::size_t kMostParts = 64;

/// Parts of a frame in the making; keeps its memory.
class PartList {
 public:
  void clear();

  /// Begins a part of this kind. Its bytes are what is appended to the writer, or to `bytes()`,
  /// until the next call.
  ByteWriter begin(std::uint8_t kind);
  [[nodiscard]] std::vector<std::byte>& bytes() { return bytes_; }

  [[nodiscard]] std::size_t size() const { return parts_.size(); }
  [[nodiscard]] std::uint8_t kind(std::size_t i) const { return parts_[i].kind; }
  /// The bytes of part `i`.
  [[nodiscard]] std::span<const std::byte> part(std::size_t i) const;
  /// Forgets all but the first `count` parts.
  void truncate(std::size_t count);

 private:
  struct Part {
    std::uint8_t kind;
    std::size_t begin;
  };
  std::vector<Part> parts_;
  std::vector<std::byte> bytes_;
};

/// Assembles a frame. `info.sensor` has at most 255 bytes.
void write_frame(CodecId codec, const SweepInfo& info, const SweepCounts& counts,
                 const PartList& parts, std::vector<std::byte>& frame);

/// Bytes of a frame of the parts from `first` on.
[[nodiscard]] std::size_t frame_size(CodecId codec, const SweepInfo& info,
                                     const SweepCounts& counts, const PartList& parts,
                                     std::size_t first);

/// Whether the frame has a part of this kind.
[[nodiscard]] bool has_part(const FrameHeader& header, std::uint8_t kind);

/// The bytes of part `kind`, after checking that they are all there and undamaged.
/// Errors: truncated, corrupt.
[[nodiscard]] Result<std::span<const std::byte>> checked_part(std::span<const std::byte> frame,
                                                              const FrameHeader& header,
                                                              std::uint8_t kind);

}  // namespace sweepcast
