// The bytes of a .sweep file around the frames: head, records, index, trailer (docs/format.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sweepcast/status.hpp"
#include "sweepcast/sweep_file.hpp"

namespace sweepcast {

inline constexpr std::size_t kSweepHeadSize = 16;
inline constexpr std::size_t kSweepTrailerSize = 16;
/// Bytes of a record before its frame, beside the name.
inline constexpr std::size_t kRecordHeadSize = 9;
inline constexpr std::size_t kMaxNameSize = 255;
inline constexpr std::uint64_t kMaxFrames = std::uint64_t{1} << 24;
inline constexpr std::uint64_t kMaxIndexSize = std::uint64_t{1} << 30;

/// Fills `out` with the bytes from `offset` on. Errors: io, truncated (the file ends before).
using ReadAt = std::function<Status(std::uint64_t offset, std::span<std::byte> out)>;

/// What follows the last whole record.
enum class SweepTail : std::uint8_t {
  none,     ///< nothing
  index,    ///< a sound index
  cut,      ///< what an interrupted recording leaves: part of a record or of an index, or zeros
  damaged,  ///< something else: frames may be hidden behind a damaged record
};

/// What a .sweep file holds.
struct SweepContents {
  std::vector<SweepEntry> entries;
  std::uint64_t records_end = 0;  ///< where the last whole record ends
  SweepTail tail = SweepTail::none;
};

/// Bytes of a new file.
void write_sweep_head(std::vector<std::byte>& out);
/// Bytes of a record before its frame. The caller has checked sizes.
void write_record_head(std::size_t frame_size, std::string_view name, std::vector<std::byte>& out);
/// Bytes of the index and the trailer.
void write_sweep_index(const std::vector<SweepEntry>& entries, std::vector<std::byte>& out);

/// True where a file of fewer bytes than a head is the beginning of one: a recording was cut as it
/// began.
[[nodiscard]] bool is_cut_head(std::span<const std::byte> bytes);

/// Finds the frames of a file of `size` bytes: by the index where there is a sound one, else by
/// walking the records. Without an index, records at the end whose frames are damaged do not count:
/// a power loss may leave a file longer than what reached the disk.
/// Messages name the file as `label`.
/// Errors: those of `read_at`, corrupt (not a .sweep file), unsupported (version).
[[nodiscard]] Result<SweepContents> scan_sweep(const ReadAt& read_at, std::uint64_t size,
                                               const std::string& label);

/// Whether `bytes` are one whole frame, no more and no less; where `with_parts`, also whether its
/// parts match their checksums. Errors: invalid_argument, with the reason.
[[nodiscard]] Status check_frame(std::span<const std::byte> bytes, bool with_parts);

}  // namespace sweepcast
