// What the tests of .sweep files share.
#pragma once

#include <gtest/gtest.h>

#include "codec/frame_layout.hpp"
#include "io/support.hpp"
#include "sweepcast/sweep_file.hpp"

namespace sweepcast::test {

using Bytes = std::vector<std::byte>;
using Mode = SweepWriter::Mode;
namespace fs = std::filesystem;

/// A frame as a codec would make it, with `size` bytes in its only part.
inline Bytes make_frame(std::uint64_t sequence, std::size_t size) {
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

inline std::string name_of(std::size_t i) {
  return "00000" + std::to_string(i);
}

inline void append_frames(SweepWriter& writer, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    const Status status = writer.append(make_frame(i, 10 + 7 * i), name_of(i));
    ASSERT_TRUE(status) << status.error().message;
  }
}

inline void write_frames(const fs::path& path, Mode mode, std::size_t begin, std::size_t end) {
  auto writer = SweepWriter::open(path, mode);
  ASSERT_TRUE(writer) << writer.error().message;
  append_frames(*writer, begin, end);
  ASSERT_TRUE(writer->close());
  EXPECT_EQ(writer->size(), fs::file_size(path));
}

inline void expect_frames(const fs::path& path, std::size_t count, bool was_cut) {
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

inline void xor_byte(Bytes& bytes, std::size_t at, unsigned with) {
  bytes[at] ^= static_cast<std::byte>(with);
}

}  // namespace sweepcast::test
