// .sweep files: whole, cut anywhere, damaged, appended to, on full disks.
#include "sweepcast/sweep_file.hpp"

#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>

#include "codec/frame_layout.hpp"
#include "core/crc32.hpp"
#include "io/support.hpp"
#include "io/sweep_layout.hpp"

namespace sweepcast {
namespace {

namespace fs = std::filesystem;
using test::expect_error;
using test::status_of;
using test::TemporaryFolder;
using Bytes = std::vector<std::byte>;
using Mode = SweepWriter::Mode;

/// A frame as a codec would make it, with `size` bytes in its only part.
Bytes make_frame(std::uint64_t sequence, std::size_t size) {
  PartList parts;
  parts.begin(1);
  for (std::size_t i = 0; i < size; ++i) {
    parts.bytes().push_back(static_cast<std::byte>(i * 31 + sequence));
  }
  Bytes frame;
  write_frame(CodecId::rcpcc, {.sequence = sequence, .stamp_ns = 5, .sensor = "test"}, {}, parts,
              frame);
  return frame;
}

std::string name_of(std::size_t i) {
  return "00000" + std::to_string(i);
}

void append_frames(SweepWriter& writer, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    const Status status = writer.append(make_frame(i, 10 + 7 * i), name_of(i));
    ASSERT_TRUE(status) << status.error().message;
  }
}

void write_frames(const fs::path& path, Mode mode, std::size_t begin, std::size_t end) {
  auto writer = SweepWriter::open(path, mode);
  ASSERT_TRUE(writer) << writer.error().message;
  append_frames(*writer, begin, end);
  ASSERT_TRUE(writer->close());
  EXPECT_EQ(writer->size(), fs::file_size(path));
}

void expect_frames(const fs::path& path, std::size_t count, bool was_cut) {
  auto reader = SweepReader::open(path);
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_EQ(reader->was_cut(), was_cut);
  EXPECT_EQ(reader->file_size(), fs::file_size(path));
  ASSERT_EQ(reader->entries().size(), count);
  Bytes frame;
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(reader->entries()[i].name, name_of(i));
    ASSERT_TRUE(reader->read(i, frame));
    EXPECT_EQ(frame, make_frame(i, 10 + 7 * i)) << i;
  }
  expect_error(reader->read(count, frame), ErrorCode::invalid_argument, "has no frame");
}

void xor_byte(Bytes& bytes, std::size_t at, unsigned with) {
  bytes[at] ^= static_cast<std::byte>(with);
}

TEST(SweepFile, GivesBackWhatWasWritten) {
  for (const Mode mode : {Mode::convert, Mode::record}) {
    for (const std::size_t count : {0U, 1U, 12U}) {
      TemporaryFolder folder;
      write_frames(folder / "a.sweep", mode, 0, count);
      expect_frames(folder / "a.sweep", count, false);
      EXPECT_EQ(folder.names(), std::vector<std::string>{"a.sweep"});
    }
  }
}

TEST(SweepFile, IsTheSameBytesInBothModes) {
  TemporaryFolder folder;
  write_frames(folder / "a.sweep", Mode::convert, 0, 5);
  write_frames(folder / "b.sweep", Mode::record, 0, 5);
  EXPECT_EQ(test::read_bytes(folder / "a.sweep"), test::read_bytes(folder / "b.sweep"));
}

TEST(SweepFile, HasTheBytesOfTheDocumentedFormat) {
  TemporaryFolder folder;
  const Bytes frame = make_frame(0, 3);
  auto writer = SweepWriter::open(folder / "a.sweep", Mode::convert);
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->append(frame, "ab"));
  ASSERT_TRUE(writer->append(frame, "ac"));
  ASSERT_TRUE(writer->close());

  Bytes expected = test::bytes_of({"SWEEPCST\1\0\0\0", 12});
  const auto put = [&](std::string_view text) {
    const Bytes bytes = test::bytes_of(text);
    expected.insert(expected.end(), bytes.begin(), bytes.end());
  };
  const auto put_u32 = [&](std::uint32_t value) {
    for (int i = 0; i < 4; ++i) expected.push_back(static_cast<std::byte>(value >> (8 * i)));
  };
  const auto put_crc = [&](std::size_t begin) {
    put_u32(crc32(std::span(expected).subspan(begin)));
  };
  put_crc(0);
  const auto size = static_cast<char>(frame.size());
  ASSERT_LT(frame.size(), 128U);  // one byte as a varint
  for (const std::string_view name : {"ab", "ac"}) {
    const std::size_t begin = expected.size();
    put({&size, 1});
    put({"\0\0\0\2", 4});
    put(name);
    put_crc(begin);
    expected.insert(expected.end(), frame.begin(), frame.end());
  }
  const std::size_t index = expected.size();
  put("\xFF\xFF\xFF\xFF\2");
  put({&size, 1});
  put({"\0\2ab", 4});
  put({&size, 1});
  put({"\1\1c", 3});
  const auto index_size = static_cast<std::uint32_t>(expected.size() - index);
  const std::uint32_t index_crc = crc32(std::span(expected).subspan(index));
  put_u32(index_size);
  put_u32(index_crc);
  put("SWEEPEND");
  EXPECT_EQ(test::read_bytes(folder / "a.sweep"), expected);
}

TEST(SweepFile, CostsLittleBesideTheFrames) {
  TemporaryFolder folder;
  auto writer = SweepWriter::open(folder / "a.sweep", Mode::convert);
  ASSERT_TRUE(writer);
  const Bytes frame = make_frame(0, 20000);
  constexpr std::size_t kCount = 100;
  for (std::size_t i = 0; i < kCount; ++i) {
    ASSERT_TRUE(writer->append(frame, std::to_string(1'000'000'000 + i)));
  }
  ASSERT_TRUE(writer->close());
  const std::uint64_t overhead = writer->size() - kCount * (frame.size() + 10);
  EXPECT_LE(overhead, kCount * 17);
}

TEST(SweepFile, CutAnywhereGivesAllWholeFrames) {
  TemporaryFolder folder;
  constexpr std::size_t kCount = 4;
  write_frames(folder / "a.sweep", Mode::record, 0, kCount);
  const Bytes bytes = test::read_bytes(folder / "a.sweep");
  const auto whole = SweepReader::open(folder / "a.sweep");
  ASSERT_TRUE(whole);
  const fs::path cut = folder / "cut.sweep";
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    test::write_bytes(cut, std::span(bytes).first(size));
    if (size < kSweepHeadSize) {
      expect_error(status_of(SweepReader::open(cut)), ErrorCode::corrupt, cut.string());
      continue;
    }
    std::size_t expected = 0;
    for (const SweepEntry& entry : whole->entries()) {
      if (entry.offset + entry.size <= size) ++expected;
    }
    expect_frames(cut, expected, true);
  }
}

TEST(SweepFile, RecordingContinuesWhereItWasCut) {
  TemporaryFolder folder;
  write_frames(folder / "a.sweep", Mode::record, 0, 3);
  const Bytes bytes = test::read_bytes(folder / "a.sweep");
  const auto whole = SweepReader::open(folder / "a.sweep");
  ASSERT_TRUE(whole);
  const fs::path cut = folder / "cut.sweep";
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    test::write_bytes(cut, std::span(bytes).first(size));
    std::size_t kept = 0;
    for (const SweepEntry& entry : whole->entries()) {
      if (entry.offset + entry.size <= size) ++kept;
    }
    write_frames(cut, Mode::record, kept, 5);
    expect_frames(cut, 5, false);
  }
}

TEST(SweepFile, RecordingIsThereBeforeItIsClosed) {
  TemporaryFolder folder;
  {
    auto writer = SweepWriter::open(folder / "a.sweep", Mode::record);
    ASSERT_TRUE(writer);
    append_frames(*writer, 0, 3);
    expect_frames(folder / "a.sweep", 3, true);
  }
  expect_frames(folder / "a.sweep", 3, true);  // as after a crash
}

TEST(SweepFile, ZerosOfAPowerLossAreNoFrames) {
  TemporaryFolder folder;
  {
    auto writer = SweepWriter::open(folder / "a.sweep", Mode::record);
    ASSERT_TRUE(writer);
    append_frames(*writer, 0, 4);
  }
  Bytes bytes = test::read_bytes(folder / "a.sweep");
  // The size of the file reached the disk, the last bytes of the last two frames did not.
  const std::size_t lost = make_frame(3, 10 + 7 * 3).size() + 20;
  std::fill(bytes.end() - static_cast<std::ptrdiff_t>(lost), bytes.end(), std::byte{0});
  test::write_bytes(folder / "a.sweep", bytes);
  expect_frames(folder / "a.sweep", 2, true);
  write_frames(folder / "a.sweep", Mode::record, 2, 5);
  expect_frames(folder / "a.sweep", 5, false);
}

TEST(SweepFile, FlippedBytesNeverGiveAWrongEntry) {
  TemporaryFolder folder;
  write_frames(folder / "a.sweep", Mode::convert, 0, 3);
  const Bytes bytes = test::read_bytes(folder / "a.sweep");
  const auto whole = SweepReader::open(folder / "a.sweep");
  ASSERT_TRUE(whole);
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const unsigned with : {0x01U, 0x80U, 0xFFU}) {
      Bytes damaged = bytes;
      xor_byte(damaged, at, with);
      test::write_bytes(folder / "b.sweep", damaged);
      const auto reader = SweepReader::open(folder / "b.sweep");
      EXPECT_EQ(reader.has_value(), at >= kSweepHeadSize) << at;
      if (!reader) continue;
      // One damaged byte costs either the index or a record's head, and the other one suffices.
      ASSERT_EQ(reader->entries().size(), 3U) << at;
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(reader->entries()[i].offset, whole->entries()[i].offset);
        EXPECT_EQ(reader->entries()[i].size, whole->entries()[i].size);
        EXPECT_EQ(reader->entries()[i].name, whole->entries()[i].name);
      }
    }
  }
}

TEST(SweepFile, SurvivesRandomDamage) {
  TemporaryFolder folder;
  write_frames(folder / "a.sweep", Mode::convert, 0, 5);
  const Bytes bytes = test::read_bytes(folder / "a.sweep");
  std::mt19937 random(3);
  std::size_t opened = 0;
  for (int trial = 0; trial < 10000; ++trial) {
    Bytes damaged = bytes;
    for (auto flips = 1 + random() % 8; flips > 0; --flips) {
      damaged[random() % damaged.size()] = static_cast<std::byte>(random());
    }
    damaged.resize(damaged.size() - random() % 40);
    const auto read = [&](std::uint64_t offset, std::span<std::byte> out) -> Status {
      EXPECT_LE(offset + out.size(), damaged.size());
      std::copy_n(damaged.begin() + static_cast<std::ptrdiff_t>(offset), out.size(), out.begin());
      return {};
    };
    const auto contents = scan_sweep(read, damaged.size(), "damaged");
    if (!contents) continue;
    ++opened;
    EXPECT_LE(contents->entries.size(), 5U);
    EXPECT_LE(contents->records_end, damaged.size());
  }
  EXPECT_GT(opened, 5000U);
}

TEST(SweepFile, RecordingNeverCutsAwayWhatADamagedRecordHides) {
  TemporaryFolder folder;
  {
    auto writer = SweepWriter::open(folder / "a.sweep", Mode::record);
    ASSERT_TRUE(writer);
    for (std::size_t i = 0; i < 4; ++i) ASSERT_TRUE(writer->append(make_frame(i, 500), name_of(i)));
  }
  Bytes bytes = test::read_bytes(folder / "a.sweep");
  xor_byte(bytes, kSweepHeadSize + 5, 1);  // the name of the first record, and there is no index
  test::write_bytes(folder / "a.sweep", bytes);
  expect_error(status_of(SweepWriter::open(folder / "a.sweep", Mode::record)), ErrorCode::corrupt,
               "record to another file");
  EXPECT_EQ(test::read_bytes(folder / "a.sweep"), bytes);
}

TEST(SweepFile, RefusesOtherFilesAndVersions) {
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
  expect_error(status_of(SweepReader::open(folder.path())), ErrorCode::io, "regular file");
}

TEST(SweepFile, RefusesWhatIsNoFrame) {
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

TEST(SweepFile, ConversionIsThereWholeOrNotAtAll) {
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

TEST(SweepFile, SaysWhereItCannotWrite) {
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

TEST(SweepFile, FullDiskCostsARecordingNoWholeFrame) {
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

TEST(SweepFile, FullDiskLeavesNothingOfAConversion) {
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

TEST(SweepFile, AFileThatShrinksWhileItIsOpenIsAnError) {
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
