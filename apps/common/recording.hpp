// The frames of a .sweep file, one after the other, as the commands that read one need them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <unordered_set>

#include "sweepcast/frame.hpp"
#include "sweepcast/sweep_file.hpp"

namespace sweepcast::app {

/// Says whether a file holds everything that was written to it.
/// No error where the index is sound, or where only the index is missing, as in a recording that
/// goes on or ended without notice between two frames. Error truncated where bytes follow the last
/// whole frame that belong to no frame: what they were is lost.
[[nodiscard]] Status check_complete(const std::filesystem::path& path, const SweepReader& reader);

/// Whether options that concern layers and points to fill in mean anything to the file's frames:
/// its first sound one tells the codec. Error invalid_argument, which says to leave `options` out.
[[nodiscard]] Status check_layered(const std::filesystem::path& path, SweepReader& reader,
                                   const std::string& options);

/// "FILE: frame 3 (000012): WHAT".
[[nodiscard]] std::string frame_error(const std::filesystem::path& path, const SweepReader& reader,
                                      std::size_t i, const std::string& what);

/// A text from a file, safe for a terminal: control characters become question marks.
[[nodiscard]] std::string printable(std::string text);

/// Whether a sweep's name can become a file's: no way out of a folder, no control character.
[[nodiscard]] bool is_plain_file_name(const std::string& name);

/// The base name of the file that a sweep was made from: the entry's own name; where it is empty,
/// the frame's sequence number with six digits.
/// Error corrupt: the name could lead out of the folder, or holds a control character.
[[nodiscard]] Result<std::string> source_name(const SweepEntry& entry, const FrameHeader& header);

/// Names the sweeps of a file so that each can become a file of its own in one folder.
class SweepNames {
 public:
  /// `source_name`; one that came before gets "-2", "-3" and so on behind it. Errors: the same.
  [[nodiscard]] Result<std::string> next(const SweepEntry& entry, const FrameHeader& header);

 private:
  std::unordered_set<std::string> used_;
};

}  // namespace sweepcast::app
