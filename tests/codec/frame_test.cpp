#include "sweepcast/frame.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "codec/frame_layout.hpp"
#include "codec/scene.hpp"
#include "repair_frame.hpp"

namespace sweepcast {
namespace {

using test::Bytes;

struct Written {
  Bytes frame;
  SweepInfo info{1234567890123456789U, -5, "lidar/front \xC3\xA9"};
  SweepCounts counts{100, 60, 1, 2, 3, 4, 30};
};

/// Parts of 3, 0 and 1000 bytes.
Written written_frame() {
  Written w;
  PartList parts;
  parts.begin(2);
  parts.bytes().insert(parts.bytes().end(), 3, std::byte{7});
  parts.begin(9);
  parts.begin(1);
  parts.bytes().insert(parts.bytes().end(), 1000, std::byte{8});
  write_frame(CodecId::rcpcc, w.info, w.counts, parts, w.frame);
  return w;
}

void expect_refused(Decoder& decoder, const Bytes& frame, const std::string& what) {
  PointCloud cloud;
  cloud.resize_xyz(3);
  const Status status = decoder.decode(frame, cloud);
  ASSERT_FALSE(status.has_value()) << what;
  EXPECT_TRUE(cloud.empty() && cloud.y.empty() && cloud.z.empty()) << what;
  EXPECT_FALSE(status.error().message.empty());
  const ErrorCode code = status.error().code;
  EXPECT_TRUE(code == ErrorCode::corrupt || code == ErrorCode::truncated ||
              code == ErrorCode::unsupported || code == ErrorCode::limit)
      << what << ": " << name(code);
}

TEST(Frame, HeadRoundTrips) {
  const Written w = written_frame();
  FrameHeader header;
  ASSERT_TRUE(parse_frame_header(w.frame, header).has_value());
  EXPECT_EQ(header.version, 1);
  EXPECT_EQ(header.codec, CodecId::rcpcc);
  EXPECT_EQ(header.sequence, w.info.sequence);
  EXPECT_EQ(header.stamp_ns, w.info.stamp_ns);
  EXPECT_EQ(header.sensor, w.info.sensor);
  EXPECT_EQ(header.counts, w.counts);
  EXPECT_EQ(header.frame_size, w.frame.size());
  EXPECT_EQ(header.header_size + 1003, header.frame_size);
  ASSERT_EQ(header.parts.size(), 3U);
  EXPECT_EQ(header.parts[0].kind, 2);
  EXPECT_EQ(header.parts[0].offset, header.header_size);
  EXPECT_EQ(header.parts[0].size, 3U);
  EXPECT_EQ(header.parts[1].size, 0U);
  EXPECT_EQ(header.parts[2].kind, 1);
  EXPECT_EQ(header.parts[2].offset, header.header_size + 3);
  EXPECT_EQ(checked_part(w.frame, header, 1)->size(), 1000U);
  EXPECT_EQ(checked_part(w.frame, header, 9)->size(), 0U);
  EXPECT_EQ(checked_part(w.frame, header, 3).error().code, ErrorCode::corrupt);
}

TEST(Frame, ExtremesOfTheHeadRoundTrip) {
  constexpr auto kMost = std::numeric_limits<std::uint32_t>::max();
  for (const std::int64_t stamp :
       {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()}) {
    const std::string sensor(255, 's');
    const SweepInfo info{std::numeric_limits<std::uint64_t>::max(), stamp, sensor};
    const SweepCounts counts{kMost, kMost, 0, kMost, 1, kMost, kMost};
    Bytes frame;
    write_frame(CodecId::rcpcc, info, counts, {}, frame);
    FrameHeader header;
    ASSERT_TRUE(parse_frame_header(frame, header).has_value());
    EXPECT_EQ(header.sequence, info.sequence);
    EXPECT_EQ(header.stamp_ns, stamp);
    EXPECT_EQ(header.sensor, sensor);
    EXPECT_EQ(header.counts, counts);
    EXPECT_TRUE(header.parts.empty());
    EXPECT_EQ(header.frame_size, frame.size());
  }
}

TEST(Frame, HeadParsesFromAPrefixOrWithMoreBehind) {
  Written w = written_frame();
  FrameHeader whole;
  ASSERT_TRUE(parse_frame_header(w.frame, whole).has_value());
  FrameHeader header;
  ASSERT_TRUE(parse_frame_header(std::span(w.frame).first(whole.header_size), header).has_value());
  EXPECT_EQ(header.frame_size, w.frame.size());
  EXPECT_EQ(header.sensor, w.info.sensor);
  EXPECT_EQ(checked_part(std::span(w.frame).first(whole.header_size + 2), header, 2).error().code,
            ErrorCode::truncated);
  w.frame.insert(w.frame.end(), 50, std::byte{1});
  ASSERT_TRUE(parse_frame_header(w.frame, header).has_value());
  EXPECT_EQ(header.frame_size, whole.frame_size);
}

TEST(Frame, AHeadCutShortIsTruncatedNotCorrupt) {
  // A reader of a stream waits for more bytes on one, and gives up on the other.
  const Written w = written_frame();
  FrameHeader header;
  ASSERT_TRUE(parse_frame_header(w.frame, header).has_value());
  const std::size_t head = header.header_size;
  for (std::size_t size = 4; size < head; ++size) {
    const Status status = parse_frame_header(std::span(w.frame).first(size), header);
    ASSERT_FALSE(status.has_value()) << size;
    EXPECT_EQ(status.error().code, ErrorCode::truncated) << size;
  }
}

TEST(Frame, SizesBeyondTheirCapsAreRefused) {
  const auto parse = [](auto write) {
    Bytes frame;
    ByteWriter out(frame);
    out.put(kFrameMagic);
    out.put(kFrameVersion);
    out.put(std::uint8_t{1});
    out.put_varint(0);
    out.put(std::int64_t{0});
    out.put_text("");
    for (int i = 0; i < 7; ++i) out.put_varint(0);
    write(out);
    out.put(crc32(frame));
    frame.resize(frame.size() + 100);
    FrameHeader header;
    const Status status = parse_frame_header(frame, header);
    return status ? std::string("ok") : std::string(name(status.error().code));
  };
  const auto part = [](ByteWriter& out, std::uint64_t size) {
    out.put(std::uint8_t{1});
    out.put_varint(size);
    out.put(std::uint32_t{0});
  };
  EXPECT_EQ(parse([&](ByteWriter& out) { out.put_varint(0); }), "ok");
  EXPECT_EQ(parse([&](ByteWriter& out) { out.put_varint(65); }), "corrupt");
  EXPECT_EQ(parse([&](ByteWriter& out) { out.put_varint(std::uint64_t{1} << 60); }), "corrupt");
  EXPECT_EQ(parse([&](ByteWriter& out) {
              out.put_varint(1);
              part(out, kLargestFrame + 1);
            }),
            "corrupt");
  EXPECT_EQ(parse([&](ByteWriter& out) {
              out.put_varint(2);
              part(out, kLargestFrame / 2);
              part(out, kLargestFrame / 2 + 1);
            }),
            "limit");
}

TEST(Frame, EverySingleFlippedByteIsFound) {
  const Bytes frame =
      test::encode({.codec = CodecId::rcpcc}, test::street(16, 180), {7, 8, "sensor"});
  Decoder decoder;
  Bytes damaged = frame;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    for (const int flip : {0x01, 0x80, 0xFF}) {
      damaged[i] = frame[i] ^ static_cast<std::byte>(flip);
      expect_refused(decoder, damaged, "byte " + std::to_string(i));
    }
    damaged[i] = frame[i];
  }
  PointCloud cloud;
  EXPECT_TRUE(decoder.decode(frame, cloud).has_value());  // and the decoder still works
}

TEST(Frame, EveryTruncationIsFound) {
  const Bytes frame =
      test::encode({.codec = CodecId::rcpcc}, test::street(16, 180), {7, 8, "sensor"});
  Decoder decoder;
  for (std::size_t size = 0; size < frame.size(); ++size) {
    expect_refused(decoder, Bytes(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(size)),
                   "size " + std::to_string(size));
  }
}

TEST(Frame, WhatIsNewerIsCalledUnsupported) {
  const Bytes frame = test::encode({.codec = CodecId::rcpcc}, test::street(4, 90));
  Decoder decoder;
  PointCloud cloud;
  const auto refused = [&](std::size_t at, int value) {
    Bytes other = frame;
    other[at] = static_cast<std::byte>(value);
    fuzz::repair_checksums(other);
    const Status status = decoder.decode(other, cloud);
    EXPECT_FALSE(status.has_value());
    EXPECT_EQ(status.error().code, ErrorCode::unsupported);
    return status.error().message;
  };
  EXPECT_NE(refused(4, 2).find("version 2"), std::string::npos);
  EXPECT_NE(refused(4, 2).find("update"), std::string::npos);
  EXPECT_NE(refused(5, 9).find("codec"), std::string::npos);
  EXPECT_EQ(name(static_cast<CodecId>(9)), "unknown");
  EXPECT_EQ(name(CodecId::rcpcc), "rcpcc");
}

TEST(Frame, OtherFilesAreNotFrames) {
  Decoder decoder;
  for (const std::string_view text :
       {"", "S", "SWPF", "# .PCD v0.7 - Point Cloud Data file", "ply\nformat"}) {
    const auto bytes = std::as_bytes(std::span(text));
    expect_refused(decoder, Bytes(bytes.begin(), bytes.end()), std::string(text));
  }
}

TEST(Frame, PointsBeyondTheDecodersLimitAreRefused) {
  const PointCloud cloud = test::street(16, 180);
  Encoder encoder = test::encoder_of({.codec = CodecId::rcpcc});
  const Bytes frame = test::encode(encoder, cloud);
  const std::uint32_t points = encoder.last_counts().points_coded;
  PointCloud decoded;
  EXPECT_TRUE(Decoder({points}).decode(frame, decoded).has_value());
  EXPECT_EQ(decoded.size(), points);
  const Status status = Decoder({points - 1}).decode(frame, decoded);
  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code, ErrorCode::limit);
  EXPECT_TRUE(decoded.empty());
}

TEST(Frame, PartsHaveNames) {
  const Bytes frame = test::encode({.codec = CodecId::rcpcc}, test::street(4, 90));
  FrameHeader header;
  ASSERT_TRUE(parse_frame_header(frame, header).has_value());
  std::string names;
  for (const FramePart& part : header.parts) {
    names += std::string(part_name(header.codec, part.kind)) + " ";
  }
  EXPECT_EQ(names, "grid occupancy surfaces unfit ");
  EXPECT_EQ(part_name(CodecId::rcpcc, 77), "unknown");
}

}  // namespace
}  // namespace sweepcast
