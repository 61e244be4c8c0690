// .sweep files: whole, cut anywhere, damaged, appended to.
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

}  // namespace
}  // namespace sweepcast
