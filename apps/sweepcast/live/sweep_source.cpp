#include "sweepcast/live/sweep_source.hpp"

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <span>

#include "codec/frame_layout.hpp"
#include "common/inputs.hpp"
#include "common/interruption.hpp"
#include "core/bytes.hpp"
#include "core/crc32.hpp"
#include "io/sweep_layout.hpp"
#include "sweepcast/cloud_file.hpp"
#include "sweepcast/sweep_file.hpp"

namespace sweepcast::app {
namespace {

namespace fs = std::filesystem;

class CloudSource : public SweepSource {
 public:
  explicit CloudSource(std::vector<fs::path> files) : files_(std::move(files)) {}

  Result<bool> next(SourceSweep& sweep) override {
    if (at_ == files_.size()) return false;
    const fs::path& file = files_[at_++];
    sweep.name = file.stem().string();
    sweep.frame.clear();
    if (Status read = read_cloud(file, sweep.cloud); !read) return tl::unexpected(read.error());
    return true;
  }
  bool rewind() override {
    at_ = 0;
    return true;
  }
  [[nodiscard]] bool gives_clouds() const override { return true; }

 private:
  std::vector<fs::path> files_;
  std::size_t at_ = 0;
};

class FileSource : public SweepSource {
 public:
  explicit FileSource(SweepReader reader) : reader_(std::move(reader)) {}

  Result<bool> next(SourceSweep& sweep) override {
    if (at_ == reader_.entries().size()) return false;
    sweep.name = reader_.entries()[at_].name;
    if (Status read = reader_.read(at_++, sweep.frame); !read) return tl::unexpected(read.error());
    return true;
  }
  bool rewind() override {
    at_ = 0;
    return true;
  }
  [[nodiscard]] bool gives_clouds() const override { return false; }

 private:
  SweepReader reader_;
  std::size_t at_ = 0;
};

/// A .sweep stream, read as it comes.
class StreamSource : public SweepSource {
 public:
  Result<bool> next(SourceSweep& sweep) override;
  bool rewind() override { return false; }
  [[nodiscard]] bool gives_clouds() const override { return false; }

 private:
  /// How reading so many bytes ended.
  enum class End : std::uint8_t { all, none, cut, failed };
  [[nodiscard]] static End read(std::span<std::byte> out);
  [[nodiscard]] static tl::unexpected<Error> bad(const std::string& what) {
    return fail(ErrorCode::corrupt, "standard input: " + what);
  }
  [[nodiscard]] Result<bool> read_head();

  bool begun_ = false;
};

StreamSource::End StreamSource::read(std::span<std::byte> out) {
  constexpr int kCheck_ms = 50;
  std::size_t done = 0;
  while (done < out.size()) {
    if (stop_requested()) return End::none;
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, kCheck_ms) == 0) continue;
    const ssize_t count = ::read(STDIN_FILENO, out.data() + done, out.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return End::failed;
    if (count == 0) return done == 0 ? End::none : End::cut;
    done += static_cast<std::size_t>(count);
  }
  return End::all;
}

Result<bool> StreamSource::read_head() {
  std::vector<std::byte> expected;
  write_sweep_head(expected);
  std::vector<std::byte> head(expected.size());
  const End end = read(head);
  if (end == End::none) return false;
  if (end != End::all || head != expected) {
    return bad("is no .sweep stream; `sweepcast encode INPUT -o /dev/stdout --append` makes one");
  }
  begun_ = true;
  return true;
}

Result<bool> StreamSource::next(SourceSweep& sweep) {
  if (!begun_) {
    auto head = read_head();
    if (!head || !*head) return head;
  }
  constexpr std::uint32_t kIndexMarker = 0xFFFFFFFF;
  std::vector<std::byte> record(sizeof(std::uint32_t));
  End end = read(record);
  if (end == End::none) return false;  // a stream may end without an index
  const auto size = ByteReader(record).get<std::uint32_t>();
  if (end == End::all && size == kIndexMarker) return false;
  record.resize(record.size() + 1);
  if (end == End::all) end = read(std::span(record).last(1));
  const auto name_size = std::to_integer<std::size_t>(record.back());
  record.resize(record.size() + name_size + sizeof(std::uint32_t));
  if (end == End::all) end = read(std::span(record).last(name_size + sizeof(std::uint32_t)));
  if (end == End::none && stop_requested()) return false;
  if (end != End::all) return bad("ends within a record; what was before it is sent");
  const std::size_t checked = record.size() - sizeof(std::uint32_t);
  ByteReader in(record);
  (void)in.get<std::uint32_t>();
  sweep.name = std::string(in.get_text());
  if (in.get<std::uint32_t>() != crc32(std::span(record).first(checked)) || size > kLargestFrame) {
    return bad("a record's head is damaged; send the stream again");
  }
  sweep.frame.resize(size);
  end = read(sweep.frame);
  if (end == End::none && stop_requested()) return false;
  if (end != End::all) return bad("ends within a frame; what was before it is sent");
  if (Status sound = check_frame(sweep.frame, true); !sound) return bad(sound.error().message);
  return true;
}

}  // namespace

Result<std::unique_ptr<SweepSource>> open_source(const std::string& input) {
  if (input == "-") return std::make_unique<StreamSource>();
  if (fs::path(input).extension() == ".sweep") {
    auto reader = SweepReader::open(input);
    if (!reader) return tl::unexpected(reader.error());
    if (reader->entries().empty()) {
      return fail(ErrorCode::invalid_argument, input + ": holds no frame; record some first");
    }
    return std::make_unique<FileSource>(std::move(*reader));
  }
  auto files = collect_clouds({input});
  if (!files) return tl::unexpected(files.error());
  return std::make_unique<CloudSource>(std::move(*files));
}

}  // namespace sweepcast::app
