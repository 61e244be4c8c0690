// The frame: the bytes that one sweep becomes. docs/format.md describes it byte by byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sweepcast/status.hpp"

namespace sweepcast {

/// How a sweep was coded.
enum class CodecId : std::uint8_t {
  rcpcc = 1,  ///< range image, surfaces and SA-DCT (the RCPCC paper, section III.B)
  beam = 2,   ///< the sensor's own geometry, within an error bound
};

/// "rcpcc" for `CodecId::rcpcc`; "unknown" for a value that this build does not know.
[[nodiscard]] std::string_view name(CodecId codec) noexcept;

/// What the caller knows of a sweep; every frame carries it.
struct SweepInfo {
  std::uint64_t sequence = 0;  ///< counts the sweeps of one sensor
  std::int64_t stamp_ns = 0;   ///< time of the first firing, nanoseconds, the caller's clock
  std::string_view sensor{};   ///< the sensor's name, at most 255 bytes of UTF-8
};

/// Where every input point went: `points_in` is the sum of all the others.
struct SweepCounts {
  std::uint32_t points_in = 0;
  std::uint32_t points_coded = 0;  ///< points that the decoder gives back
  std::uint32_t not_finite = 0;    ///< a coordinate was NaN or infinite
  std::uint32_t zero_range = 0;    ///< the sensor's mark for "no return"
  std::uint32_t cropped = 0;       ///< left out by the crop that the caller asked for
  std::uint32_t out_of_view = 0;   ///< outside the field of view or beyond the largest range
  std::uint32_t collided = 0;      ///< another point won the same cell
  std::uint32_t thinned = 0;       ///< left out where interpolation comes near: codec beam's levels

  [[nodiscard]] bool operator==(const SweepCounts&) const = default;
};

/// A part of a frame that has its own checksum.
struct FramePart {
  std::uint8_t kind = 0;    ///< codec-specific; `part_name` tells
  std::size_t offset = 0;   ///< bytes from the start of the frame
  std::size_t size = 0;     ///< bytes
  std::uint32_t crc32 = 0;  ///< of the part's bytes
};

/// The parsed head of a frame.
struct FrameHeader {
  std::uint8_t version = 1;
  CodecId codec = CodecId::rcpcc;
  std::uint64_t sequence = 0;
  std::int64_t stamp_ns = 0;
  std::string sensor;
  SweepCounts counts;
  std::vector<FramePart> parts;
  std::size_t header_size = 0;  ///< bytes before the first part
  std::size_t frame_size = 0;   ///< bytes of the whole frame
};

/// Reads and checks the head of the frame at the start of `bytes`, which may hold more than the
/// frame, or be cut after the head. Reuses the memory of `header`.
/// Errors: truncated, corrupt (magic, checksum, sizes), unsupported (version, codec), limit.
[[nodiscard]] Status parse_frame_header(std::span<const std::byte> bytes, FrameHeader& header);

/// The name of a part, as in "occupancy"; "unknown" where the codec has no such part.
[[nodiscard]] std::string_view part_name(CodecId codec, std::uint8_t kind) noexcept;

}  // namespace sweepcast
