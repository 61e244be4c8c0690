#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <optional>
#include <string>

#include "codec/frame_layout.hpp"
#include "io/file.hpp"
#include "io/sweep_layout.hpp"
#include "sweepcast/sweep_file.hpp"

namespace sweepcast {
namespace {

using std::chrono::steady_clock;

/// How much of a recording a power loss may cost.
constexpr std::chrono::seconds kSyncInterval{1};

Status refuse(const std::filesystem::path& path, const std::string& why) {
  return fail(ErrorCode::invalid_argument, path.string() + ": " + why);
}

/// A file that is written in place and grows by whole pieces.
struct Recording {
  std::filesystem::path path;
  FileHandle handle;
  bool regular = true;  ///< a pipe or device can neither be cut back nor synchronised
  steady_clock::time_point synced = steady_clock::now();

  /// Makes the file `size` bytes long and continues there.
  [[nodiscard]] Status cut(std::uint64_t size) const {
    if (!regular) return {};
    const auto end = static_cast<off_t>(size);
    if (::ftruncate(handle.get(), end) != 0 || ::lseek(handle.get(), end, SEEK_SET) < 0) {
      return io_failure(path, "cannot be cut to its whole frames", errno);
    }
    return {};
  }

  /// Adds a piece to a file of `size` bytes; if that fails, the file is as before.
  [[nodiscard]] Status write(std::span<const std::byte> piece, std::uint64_t size) const {
    const int reason = write_all(handle.get(), piece);
    if (reason == 0) return {};
    if (Status status = cut(size); !status) return status;
    return io_failure(path, "cannot be written, the frames so far are kept", reason);
  }

  [[nodiscard]] Status sync() {
    synced = steady_clock::now();
    if (regular && ::fdatasync(handle.get()) != 0) {
      return io_failure(path, "cannot be brought to the disk", errno);
    }
    return {};
  }
};

}  // namespace

struct SweepWriter::State {
  std::filesystem::path path;
  std::optional<NewFile> conversion;   // mode convert
  std::optional<Recording> recording;  // mode record; neither once closed or failed
  std::uint64_t size = 0;
  std::uint64_t index_size = 0;  // upper bound
  std::vector<SweepEntry> entries;
  std::vector<std::byte> head, buffer;

  [[nodiscard]] Status start_recording();
  [[nodiscard]] Status continue_recording(std::uint64_t old_size);
  [[nodiscard]] Status write(std::span<const std::byte> piece);
  void add_entry(SweepEntry entry);
};

/// Opens the file of a recording, and takes over what is in it.
Status SweepWriter::State::start_recording() {
  constexpr mode_t kMode = 0666;
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  const bool regular = !std::filesystem::exists(status) || std::filesystem::is_regular_file(status);
  const int flags = regular ? O_RDWR | O_CREAT : O_WRONLY;
  FileHandle handle(::open(path.c_str(), flags | O_CLOEXEC, kMode));
  if (handle.get() < 0 && errno == ENOENT) {
    return fail(ErrorCode::io,
                path.string() + ": cannot be written, its folder does not exist; make the folder");
  }
  if (handle.get() < 0) return io_failure(path, "cannot be written", errno);
  // Two writers would overwrite each other's frames. The lock goes with the descriptor.
  if (regular && ::flock(handle.get(), LOCK_EX | LOCK_NB) != 0) {
    return fail(ErrorCode::io, path.string() +
                                   ": another program is recording into it; wait for its end, or "
                                   "record into another file");
  }
  struct stat info {};
  if (::fstat(handle.get(), &info) != 0) return io_failure(path, "cannot be read", errno);
  recording = Recording{path, std::move(handle), regular};
  return continue_recording(regular ? static_cast<std::uint64_t>(info.st_size) : 0);
}

Status SweepWriter::State::continue_recording(std::uint64_t old_size) {
  const auto read = [&](std::uint64_t offset, std::span<std::byte> out) {
    return read_at(recording->handle, path, offset, out);
  };
  if (old_size < kSweepHeadSize) {
    std::vector<std::byte> begin(static_cast<std::size_t>(old_size));
    if (Status status = read(0, begin); !status) return status;
    if (is_cut_head(begin)) {
      if (Status status = recording->cut(0); !status) return status;
      return write(head);
    }
  }
  auto contents = scan_sweep(read, old_size, path.string());
  if (!contents) return tl::unexpected(contents.error());
  if (contents->tail == SweepTail::damaged) {
    return fail(ErrorCode::corrupt, path.string() + ": is damaged at byte " +
                                        std::to_string(contents->records_end) +
                                        ", and appending would destroy what follows; record to "
                                        "another file");
  }
  for (SweepEntry& entry : contents->entries) add_entry(std::move(entry));
  size = contents->records_end;
  return recording->cut(size);
}

/// Adds a whole piece to the file. A conversion that fails leaves nothing behind.
Status SweepWriter::State::write(std::span<const std::byte> piece) {
  Status status = recording ? recording->write(piece, size) : conversion->write(piece);
  if (status) {
    size += piece.size();
  } else {
    conversion.reset();
  }
  return status;
}

void SweepWriter::State::add_entry(SweepEntry entry) {
  constexpr std::uint64_t kEntryHead = 8;  // size, shared and length of the name, at most
  index_size += kEntryHead + entry.name.size();
  entries.push_back(std::move(entry));
}

SweepWriter::SweepWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
SweepWriter::SweepWriter(SweepWriter&&) noexcept = default;
SweepWriter& SweepWriter::operator=(SweepWriter&&) noexcept = default;
SweepWriter::~SweepWriter() = default;

Result<SweepWriter> SweepWriter::open(const std::filesystem::path& path, Mode mode) {
  auto state = std::make_unique<State>();
  state->path = path;
  write_sweep_head(state->head);
  Status status;
  if (mode == Mode::record) {
    status = state->start_recording();
  } else {
    auto file = NewFile::create(path);
    if (!file) return tl::unexpected(file.error());
    state->conversion = std::move(*file);
    status = state->write(state->head);
  }
  if (!status) return tl::unexpected(status.error());
  return SweepWriter(std::move(state));
}

Status SweepWriter::append(std::span<const std::byte> frame, std::string_view name) {
  State& state = *state_;
  if (!state.conversion && !state.recording) return refuse(state.path, "is closed; open it again");
  if (name.size() > kMaxNameSize) {
    return refuse(state.path, "a frame's name is longer than 255 bytes; shorten it");
  }
  if (frame.size() > kLargestFrame || state.entries.size() >= kMaxFrames ||
      state.index_size + kMaxNameSize > kMaxIndexSize) {
    return refuse(state.path,
                  "a .sweep file cannot take this frame (256 MiB a frame, 2^24 frames); "
                  "begin another file");
  }
  if (Status status = check_frame(frame, false); !status) {
    return refuse(state.path, "cannot take " + status.error().message + "; encode the sweep again");
  }
  write_record_head(frame.size(), name, state.buffer);
  SweepEntry entry{state.size + state.buffer.size(), frame.size(), std::string(name)};
  state.buffer.insert(state.buffer.end(), frame.begin(), frame.end());
  if (Status status = state.write(state.buffer); !status) return status;
  state.add_entry(std::move(entry));
  if (state.recording && steady_clock::now() - state.recording->synced >= kSyncInterval) {
    return state.recording->sync();
  }
  return {};
}

Status SweepWriter::close() {
  State& state = *state_;
  if (!state.conversion && !state.recording) return refuse(state.path, "is closed already");
  write_sweep_index(state.entries, state.buffer);
  Status status = state.write(state.buffer);
  if (status) {
    status = state.recording ? state.recording->sync() : state.conversion->commit(true);
  }
  state.conversion.reset();
  state.recording.reset();
  return status;
}

std::uint64_t SweepWriter::size() const noexcept {
  return state_->size;
}

}  // namespace sweepcast
