#include <sys/stat.h>

#include <cerrno>
#include <string>

#include "io/file.hpp"
#include "io/sweep_layout.hpp"
#include "sweepcast/sweep_file.hpp"

namespace sweepcast {

struct SweepReader::State {
  std::filesystem::path path;
  FileHandle handle;
  std::uint64_t file_size = 0;
  SweepContents contents;
};

SweepReader::SweepReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
SweepReader::SweepReader(SweepReader&&) noexcept = default;
SweepReader& SweepReader::operator=(SweepReader&&) noexcept = default;
SweepReader::~SweepReader() = default;

Result<SweepReader> SweepReader::open(const std::filesystem::path& path) {
  auto handle = open_for_reading(path);
  if (!handle) return tl::unexpected(handle.error());
  struct stat info {};
  if (::fstat(handle->get(), &info) != 0) return io_failure(path, "cannot be read", errno);
  auto state = std::make_unique<State>();
  state->path = path;
  state->handle = std::move(*handle);
  state->file_size = static_cast<std::uint64_t>(info.st_size);
  const auto read = [&](std::uint64_t offset, std::span<std::byte> out) {
    return read_at(state->handle, path, offset, out);
  };
  auto contents = scan_sweep(read, state->file_size, path.string());
  if (!contents) return tl::unexpected(contents.error());
  state->contents = std::move(*contents);
  return SweepReader(std::move(state));
}

const std::vector<SweepEntry>& SweepReader::entries() const noexcept {
  return state_->contents.entries;
}

std::uint64_t SweepReader::file_size() const noexcept {
  return state_->file_size;
}

bool SweepReader::was_cut() const noexcept {
  return state_->contents.tail != SweepTail::index;
}

Status SweepReader::read(std::size_t i, std::vector<std::byte>& frame) {
  if (i >= entries().size()) {
    return fail(ErrorCode::invalid_argument,
                state_->path.string() + ": has no frame " + std::to_string(i) + "; it has " +
                    std::to_string(entries().size()) + ", counted from 0");
  }
  const SweepEntry& entry = entries()[i];
  frame.resize(static_cast<std::size_t>(entry.size));
  return read_at(state_->handle, state_->path, entry.offset, frame);
}

}  // namespace sweepcast
