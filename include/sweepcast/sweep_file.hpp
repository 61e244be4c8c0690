// Frames in files: the .sweep format. Part of library sweepcast::io. docs/format.md has the bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sweepcast/frame.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast {

/// Where a frame lies in a .sweep file.
struct SweepEntry {
  std::uint64_t offset = 0;  ///< bytes from the start of the file to the frame
  std::uint64_t size = 0;    ///< bytes of the frame
  std::string name;          ///< base name of the file it was made from; may be empty
};

/// Writes a .sweep file.
class SweepWriter {
 public:
  /// How the file comes into being.
  enum class Mode : std::uint8_t {
    convert,  ///< under a temporary name, renamed by `close`: whole or not at all
    record,  ///< in place, each frame in the file when `append` returns; appends to an existing one
  };

  /// A path that is there and is no regular file (a device, a pipe) is written directly.
  /// Errors: io, and in mode record corrupt or unsupported where the existing file is not .sweep,
  /// or is damaged so that appending would destroy frames. A file that was cut is no error:
  /// recording goes on behind its last whole frame.
  [[nodiscard]] static Result<SweepWriter> open(const std::filesystem::path& path, Mode mode);

  SweepWriter(SweepWriter&&) noexcept;
  SweepWriter& operator=(SweepWriter&&) noexcept;
  /// Without `close`: mode convert leaves nothing behind, mode record leaves every whole frame.
  ~SweepWriter();

  /// Adds a frame; `name` is the base name of its source, at most 255 bytes, or empty.
  /// In mode record a crash of the program loses nothing of it, a power loss at most what was added
  /// since the last call that reached the disk: one a second does.
  /// Errors: io (such as a full disk: mode record keeps all frames before and may go on, mode
  /// convert leaves nothing behind), invalid_argument (not a frame, name too long, closed).
  [[nodiscard]] Status append(std::span<const std::byte> frame, std::string_view name);

  /// Writes the index, flushes to disk, and in mode convert renames. Errors: io.
  [[nodiscard]] Status close();

  /// Bytes of the file so far; after `close`, of the whole file.
  [[nodiscard]] std::uint64_t size() const noexcept;

 private:
  struct State;
  explicit SweepWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Reads a .sweep file; the frames stay on disk until they are asked for.
class SweepReader {
 public:
  /// Opens by the index where there is a sound one, else by walking the frames: a file that was
  /// cut short opens with all its whole frames, and `was_cut` says so.
  /// Errors: not_found, io, corrupt (not a .sweep file, or its head is damaged), unsupported
  /// (version).
  [[nodiscard]] static Result<SweepReader> open(const std::filesystem::path& path);

  SweepReader(SweepReader&&) noexcept;
  SweepReader& operator=(SweepReader&&) noexcept;
  ~SweepReader();

  [[nodiscard]] const std::vector<SweepEntry>& entries() const noexcept;
  [[nodiscard]] std::uint64_t file_size() const noexcept;
  /// True where the index was missing or wrong and the entries come from walking the frames.
  [[nodiscard]] bool was_cut() const noexcept;

  /// Reads frame `i` into `frame`, whose memory is reused. Errors: invalid_argument, io, truncated.
  [[nodiscard]] Status read(std::size_t i, std::vector<std::byte>& frame);

 private:
  struct State;
  explicit SweepReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace sweepcast
