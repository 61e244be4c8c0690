// Files, by the operating system's own calls: errors tell the path, what failed and the remedy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "io/unfinished.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast {

/// An open file descriptor, closed at the end of its life.
class FileHandle {
 public:
  FileHandle() = default;
  explicit FileHandle(int descriptor) noexcept : descriptor_(descriptor) {}
  FileHandle(FileHandle&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  FileHandle& operator=(FileHandle&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  ~FileHandle() { (void)close(); }

  [[nodiscard]] int get() const noexcept { return descriptor_; }
  /// False where the system reports a write error that it had kept back until now.
  [[nodiscard]] bool close() noexcept;

 private:
  int descriptor_ = -1;
};

/// The error of a system call that left `error_number` in errno; `action` as in "cannot be read".
[[nodiscard]] tl::unexpected<Error> io_failure(const std::filesystem::path& path,
                                               std::string_view action, int error_number);

/// Opens a file for reading. Errors: not_found, io (also what is no regular file: a pipe or a
/// device might never end).
[[nodiscard]] Result<FileHandle> open_for_reading(const std::filesystem::path& path);

/// Reads a whole file into `bytes`, whose memory is reused. Errors: not_found, io, limit (the file
/// is larger than `cap` bytes).
[[nodiscard]] Status read_file(const std::filesystem::path& path, std::size_t cap,
                               std::vector<std::byte>& bytes);

/// Fills `out` with the bytes of an open file from `offset` on; `path` is for messages.
/// Errors: io, truncated (the file ends before).
[[nodiscard]] Status read_at(const FileHandle& handle, const std::filesystem::path& path,
                             std::uint64_t offset, std::span<std::byte> out);

/// Writes all of `bytes` at the descriptor's position. Returns 0, or the error number.
[[nodiscard]] int write_all(int descriptor, std::span<const std::byte> bytes) noexcept;

/// A file that comes into being whole or not at all: it is written under a temporary name in its
/// own folder and renamed by `commit`. A path that is there and is no regular file (a pipe, a
/// device) is written directly.
class NewFile {
 public:
  /// Errors: io.
  [[nodiscard]] static Result<NewFile> create(const std::filesystem::path& path);

  /// Where the bytes are written until `commit`, which without it is removed; or the path itself.
  [[nodiscard]] const std::filesystem::path& written_path() const noexcept {
    return temporary_.empty() ? path_ : temporary_.path();
  }

  /// Adds bytes at the end. Errors: io.
  [[nodiscard]] Status write(std::span<const std::byte> bytes);

  /// Gives the file its name; with `durable`, only once its bytes are on the disk. Errors: io.
  [[nodiscard]] Status commit(bool durable);

 private:
  NewFile(std::filesystem::path path, Unfinished temporary, FileHandle handle);

  std::filesystem::path path_;
  Unfinished temporary_;  ///< empty where the path is written directly, and once done
  FileHandle handle_;
};

/// Writes a whole file, which is then there whole or not at all. Errors: io.
[[nodiscard]] Status write_file(const std::filesystem::path& path,
                                std::span<const std::byte> bytes);

/// Whether `write_file` could begin: to be asked before a long work whose result goes there.
/// Errors: io.
[[nodiscard]] Status check_writable(const std::filesystem::path& path);

}  // namespace sweepcast
