// .sweep files: what is refused, and what a full disk costs.
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>

#include "core/crc32.hpp"
#include "io/sweep_layout.hpp"
#include "io/sweep_support.hpp"

namespace sweepcast {
namespace {

namespace fs = std::filesystem;
using test::append_frames;
using test::Bytes;
using test::expect_error;
using test::expect_frames;
using test::make_frame;
using test::Mode;
using test::name_of;
using test::status_of;
using test::TemporaryFolder;
using test::write_frames;
using test::xor_byte;

TEST(SweepFailure, RefusesOtherFilesAndVersions) {
  TemporaryFolder folder;
  const fs::path path = folder / "a.sweep";
  const auto both = [&](ErrorCode code, std::string_view part) {
    const Bytes before = test::read_bytes(path);
    expect_error(status_of(SweepReader::open(path)), code, part);
    expect_error(status_of(SweepWriter::open(path, Mode::record)), code, part);
    EXPECT_EQ(test::read_bytes(path), before);
  };
  test::write_text(path, std::string(100, 'x'));
  both(ErrorCode::corrupt, "is not a .sweep file");
  test::write_text(path, "short");
  both(ErrorCode::corrupt, "is not a .sweep file");

  Bytes head;
  write_sweep_head(head);
  xor_byte(head, 9, 1);
  test::write_bytes(path, head);
  both(ErrorCode::corrupt, "its head is damaged");
  const std::uint32_t crc = crc32(std::span(head).first(12));
  for (std::size_t i = 0; i < 4; ++i) head[12 + i] = static_cast<std::byte>(crc >> (8 * i));
  test::write_bytes(path, head);
  both(ErrorCode::unsupported, "version 257");

  test::write_text(path, "");
  expect_error(status_of(SweepReader::open(path)), ErrorCode::corrupt, "is empty");
  expect_error(status_of(SweepReader::open(folder / "none.sweep")), ErrorCode::not_found, "none");
  expect_error(status_of(SweepReader::open(folder.path())), ErrorCode::io,
               "is a folder; name a file");
}

TEST(SweepFailure, RefusesWhatIsNoFrame) {
  TemporaryFolder folder;
  auto writer = SweepWriter::open(folder / "a.sweep", Mode::convert);
  ASSERT_TRUE(writer);
  const auto invalid = ErrorCode::invalid_argument;
  Bytes frame = make_frame(0, 10);
  expect_error(writer->append({}, "a"), invalid, "not a frame");
  expect_error(writer->append(test::bytes_of("what is this?"), "a"), invalid, "not a frame");
  expect_error(writer->append(std::span(frame).first(frame.size() - 1), "a"), invalid,
               "whole frame");
  expect_error(writer->append(frame, std::string(256, 'n')), invalid, "255 bytes");
  frame.push_back(std::byte{0});
  expect_error(writer->append(frame, "a"), invalid, "whole frame");
  frame.pop_back();
  EXPECT_TRUE(writer->append(frame, std::string(255, 'n')));
  EXPECT_TRUE(writer->append(frame, ""));
  ASSERT_TRUE(writer->close());
  expect_error(writer->append(frame, "a"), invalid, "is closed");
  expect_error(writer->close(), invalid, "closed already");
  const auto reader = SweepReader::open(folder / "a.sweep");
  ASSERT_TRUE(reader);
  ASSERT_EQ(reader->entries().size(), 2U);
  EXPECT_EQ(reader->entries()[0].name, std::string(255, 'n'));
  EXPECT_EQ(reader->entries()[1].name, "");
}

TEST(SweepFailure, ConversionIsThereWholeOrNotAtAll) {
  TemporaryFolder folder;
  write_frames(folder / "a.sweep", Mode::convert, 0, 2);
  {
    auto writer = SweepWriter::open(folder / "a.sweep", Mode::convert);
    ASSERT_TRUE(writer);
    append_frames(*writer, 0, 4);
    EXPECT_EQ(folder.names().size(), 2U);
  }
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.sweep"});
  expect_frames(folder / "a.sweep", 2, false);
}

TEST(SweepFailure, SaysWhereItCannotWrite) {
  TemporaryFolder folder;
  for (const Mode mode : {Mode::convert, Mode::record}) {
    expect_error(status_of(SweepWriter::open(folder / "no/a.sweep", mode)), ErrorCode::io,
                 "make the folder");
    expect_error(status_of(SweepWriter::open(folder.path(), mode)), ErrorCode::io, "name a file");
    if (fs::exists("/dev/full")) {
      expect_error(status_of(SweepWriter::open("/dev/full", mode)), ErrorCode::io,
                   "free some space");
    }
    auto writer = SweepWriter::open("/dev/null", mode);
    ASSERT_TRUE(writer);
    EXPECT_TRUE(writer->append(make_frame(0, 10), "a"));
    EXPECT_TRUE(writer->close());
    if (::geteuid() == 0) continue;  // root may write everywhere
    ::chmod(folder.path().c_str(), 0500);
    expect_error(status_of(SweepWriter::open(folder / "a.sweep", mode)), ErrorCode::io,
                 "permissions");
    ::chmod(folder.path().c_str(), 0700);
  }
}

TEST(SweepFailure, OneRecorderAtATime) {
  TemporaryFolder folder;
  auto writer = SweepWriter::open(folder / "a.sweep", Mode::record);
  ASSERT_TRUE(writer);
  expect_error(status_of(SweepWriter::open(folder / "a.sweep", Mode::record)), ErrorCode::io,
               "another program is recording");
  EXPECT_TRUE(writer->append(make_frame(0, 10), "a"));
  EXPECT_TRUE(writer->close());
  EXPECT_TRUE(SweepWriter::open(folder / "a.sweep", Mode::record));
}

/// While it lives, files of this process cannot grow beyond `bytes`: a stand-in for a full disk.
class SmallDisk {
 public:
  explicit SmallDisk(rlim_t bytes) {
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit small{bytes, old_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  ~SmallDisk() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    (void)std::signal(SIGXFSZ, old_handler_);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

 private:
  rlimit old_{};
  void (*old_handler_)(int) = SIG_DFL;
};

TEST(SweepFailure, FullDiskCostsARecordingNoWholeFrame) {
  TemporaryFolder folder;
  const fs::path path = folder / "a.sweep";
  auto writer = SweepWriter::open(path, Mode::record);
  ASSERT_TRUE(writer);
  append_frames(*writer, 0, 2);
  const std::uint64_t whole = writer->size();
  {
    const SmallDisk disk(whole + 30);  // room for a part of the next record
    expect_error(writer->append(make_frame(2, 10 + 7 * 2), name_of(2)), ErrorCode::io,
                 "the frames so far are kept");
    EXPECT_EQ(writer->size(), whole);
    EXPECT_EQ(fs::file_size(path), whole);
  }
  append_frames(*writer, 2, 3);  // there is room again
  {
    const SmallDisk disk(writer->size() + 5);
    expect_error(writer->close(), ErrorCode::io, "the frames so far are kept");
  }
  expect_frames(path, 3, true);
}

TEST(SweepFailure, FullDiskLeavesNothingOfAConversion) {
  TemporaryFolder folder;
  auto writer = SweepWriter::open(folder / "a.sweep", Mode::convert);
  ASSERT_TRUE(writer);
  append_frames(*writer, 0, 2);
  {
    const SmallDisk disk(writer->size() + 30);
    expect_error(writer->append(make_frame(2, 100), "b"), ErrorCode::io, "cannot be written");
  }
  EXPECT_TRUE(folder.names().empty());
  expect_error(writer->append(make_frame(2, 100), "b"), ErrorCode::invalid_argument, "closed");
}

TEST(SweepFailure, AFileThatShrinksWhileItIsOpenIsAnError) {
  TemporaryFolder folder;
  write_frames(folder / "a.sweep", Mode::convert, 0, 3);
  auto reader = SweepReader::open(folder / "a.sweep");
  ASSERT_TRUE(reader);
  fs::resize_file(folder / "a.sweep", reader->entries()[1].offset + 3);
  Bytes frame;
  EXPECT_TRUE(reader->read(0, frame));
  expect_error(reader->read(1, frame), ErrorCode::truncated, "ends at byte");
}

}  // namespace
}  // namespace sweepcast
