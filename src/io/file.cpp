#include "io/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

namespace sweepcast {
namespace {

namespace fs = std::filesystem;

std::string_view remedy(int error_number) {
  switch (error_number) {
    case ENOENT:
      return "check the path";
    case EACCES:
    case EPERM:
      return "check the permissions of the file and its folder";
    case ENOSPC:
    case EDQUOT:
      return "free some space, or choose another disk";
    case EFBIG:
      return "raise the limit on file sizes, or choose another disk";
    case EROFS:
      return "choose a folder that can be written to";
    case EISDIR:
      return "name a file";
    case ENOTDIR:
      return "a file stands where a folder should; choose another path";
    case EIO:
      return "check the disk";
    default:
      return "check the path and the disk";
  }
}

/// A name for the unfinished file, beside the finished one so that renaming stays on one disk.
fs::path temporary_name(const fs::path& path, int attempt) {
  constexpr std::size_t kLongestStem = 200;  // file systems end at 255 bytes
  std::string name = ".";
  name += path.filename().string().substr(0, kLongestStem);
  name += ".";
  name += std::to_string(::getpid());
  if (attempt > 0) (name += "-") += std::to_string(attempt);
  name += ".tmp";
  return path.parent_path() / name;
}

}  // namespace

bool FileHandle::close() noexcept {
  const int descriptor = std::exchange(descriptor_, -1);
  return descriptor < 0 || ::close(descriptor) == 0;
}

tl::unexpected<Error> io_failure(const fs::path& path, std::string_view action, int error_number) {
  std::string message = path.string();
  message += ": ";
  message += action;
  message += " (" + std::generic_category().message(error_number) + "); ";
  message += remedy(error_number);
  return fail(error_number == ENOENT ? ErrorCode::not_found : ErrorCode::io, std::move(message));
}

Result<FileHandle> open_for_reading(const fs::path& path) {
  // Without O_NONBLOCK, a pipe would make us wait for its writer before we see what it is.
  FileHandle handle(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  struct stat info {};
  if (handle.get() < 0 || ::fstat(handle.get(), &info) != 0) {
    return io_failure(path, "cannot be opened", errno);
  }
  if (S_ISREG(info.st_mode)) return handle;
  const char* what = S_ISDIR(info.st_mode) ? "is a folder; name a file"
                                           : "is a pipe or a device; copy what it gives into a "
                                             "file, and name that";
  return fail(ErrorCode::io, path.string() + ": " + what);
}

Status read_file(const fs::path& path, std::size_t cap, std::vector<std::byte>& bytes) {
  auto handle = open_for_reading(path);
  if (!handle) return tl::unexpected(handle.error());
  struct stat info {};
  if (::fstat(handle->get(), &info) != 0) return io_failure(path, "cannot be read", errno);

  // A file may grow, and those of /proc announce no size: read until the end, or beyond the cap.
  constexpr std::size_t kChunk = std::size_t{1} << 16;
  const std::size_t announced = info.st_size > 0 ? static_cast<std::size_t>(info.st_size) : 0;
  bytes.resize(announced < cap ? announced + 1 : 1);
  std::size_t size = 0;
  while (announced <= cap && size <= cap) {
    if (size == bytes.size()) bytes.resize(size + kChunk < cap ? size + kChunk : cap + 1);
    const ssize_t got = ::read(handle->get(), bytes.data() + size, bytes.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return io_failure(path, "cannot be read", errno);
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  if (announced > cap || size > cap) {
    return fail(ErrorCode::limit,
                path.string() + ": is larger than " + std::to_string(cap >> 20) + " MiB; split it");
  }
  bytes.resize(size);
  return {};
}

Status read_at(const FileHandle& handle, const fs::path& path, std::uint64_t offset,
               std::span<std::byte> out) {
  while (!out.empty()) {
    const ssize_t got = ::pread(handle.get(), out.data(), out.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return io_failure(path, "cannot be read", errno);
    if (got == 0) {
      return fail(ErrorCode::truncated, path.string() + ": ends at byte " + std::to_string(offset) +
                                            ", before its data does; copy it again");
    }
    offset += static_cast<std::uint64_t>(got);
    out = out.subspan(static_cast<std::size_t>(got));
  }
  return {};
}

int write_all(int descriptor, std::span<const std::byte> bytes) noexcept {
  while (!bytes.empty()) {
    const ssize_t done = ::write(descriptor, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return errno;
    bytes = bytes.subspan(static_cast<std::size_t>(done));
  }
  return 0;
}

NewFile::NewFile(fs::path path, Unfinished temporary, FileHandle handle)
    : path_(std::move(path)), temporary_(std::move(temporary)), handle_(std::move(handle)) {}

Result<NewFile> NewFile::create(const fs::path& path) {
  constexpr int kFlags = O_WRONLY | O_CLOEXEC;
  constexpr mode_t kMode = 0666;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) return io_failure(path, "cannot be written", EISDIR);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    FileHandle handle(::open(path.c_str(), kFlags));
    if (handle.get() < 0) return io_failure(path, "cannot be written", errno);
    return NewFile(path, {}, std::move(handle));
  }
  // Renaming onto a symbolic link would replace the link: write where it points.
  fs::path target = fs::exists(status) ? fs::canonical(path, error) : path;
  if (error && fs::exists(status)) return io_failure(path, "cannot be written", error.value());

  constexpr int kAttempts = 100;  // names may be taken by files that a crash left behind
  for (int attempt = 0;; ++attempt) {
    Unfinished temporary(temporary_name(target, attempt));
    FileHandle handle(::open(temporary.path().c_str(), kFlags | O_CREAT | O_EXCL, kMode));
    if (handle.get() >= 0) {
      return NewFile(std::move(target), std::move(temporary), std::move(handle));
    }
    const int reason = errno;
    temporary.forget();  // somebody else's, or none
    if (reason == EEXIST && attempt < kAttempts) continue;
    if (reason != ENOENT) return io_failure(path, "cannot be written", reason);
    return fail(ErrorCode::io,
                path.string() + ": cannot be written, its folder does not exist; make the folder");
  }
}

Status NewFile::write(std::span<const std::byte> bytes) {
  const int reason = write_all(handle_.get(), bytes);
  if (reason != 0) return io_failure(path_, "cannot be written", reason);
  return {};
}

Status NewFile::commit(bool durable) {
  const bool direct = temporary_.empty();
  if (durable && !direct && ::fdatasync(handle_.get()) != 0) {
    return io_failure(path_, "cannot be written", errno);
  }
  if (!handle_.close()) return io_failure(path_, "cannot be written", errno);
  if (direct) return {};
  const int reason = temporary_.rename_to(path_);
  return reason == 0 ? Status{} : io_failure(path_, "cannot be written", reason);
}

Status write_file(const fs::path& path, std::span<const std::byte> bytes) {
  auto file = NewFile::create(path);
  if (!file) return tl::unexpected(file.error());
  if (Status status = file->write(bytes); !status) return status;
  return file->commit(false);
}

Status check_writable(const fs::path& path) {
  const auto file = NewFile::create(path);
  return file ? Status{} : tl::unexpected(file.error());
}

}  // namespace sweepcast
