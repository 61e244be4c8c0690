// Damaged frames: an error and no cloud, or a cloud that the head announces; never a crash.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "codec/damage.hpp"
#include "codec/entropy/zstd_coder.hpp"
#include "codec/frame_layout.hpp"
#include "codec/scene.hpp"
#include "repair_frame.hpp"

namespace sweepcast {
namespace {

using test::Bytes;
using test::mutate;
using test::random_bits;

std::vector<Bytes> sound_frames() {
  std::vector<Bytes> frames;
  for (const EncoderOptions& options : test::all_options()) {
    const bool fine = options.rcpcc.params.azimuth_step_deg < 0.1;
    frames.push_back(
        test::encode(options, fine ? PointCloud{} : test::street(8, 240), {1, 2, "s"}));
  }
  return frames;
}

/// Decodes; gives whether it succeeded.
bool expect_plausible(Decoder& decoder, const Bytes& frame, PointCloud& cloud) {
  const Status status = decoder.decode(frame, cloud);
  if (!status) {
    EXPECT_TRUE(cloud.empty() && cloud.y.empty() && cloud.z.empty());
    EXPECT_FALSE(status.error().message.empty());
    return false;
  }
  EXPECT_EQ(cloud.size(), decoder.last_header().counts.points_coded);
  EXPECT_EQ(cloud.y.size(), cloud.size());
  EXPECT_EQ(cloud.z.size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!(std::hypot(cloud.x[i], cloud.y[i], cloud.z[i]) <= 2001.0F)) {
      ADD_FAILURE() << "point " << i << " is farther than any range that a frame can say";
      break;
    }
  }
  return true;
}

TEST(Mutation, ChecksumsFindTheDamage) {
  std::mt19937 random(1);
  const std::vector<Bytes> frames = sound_frames();
  Decoder decoder;
  PointCloud cloud;
  for (int i = 0; i < 10000; ++i) {
    const Bytes& sound = frames[random_bits(random) % frames.size()];
    Bytes damaged = sound;
    mutate(random, frames, damaged);
    if (!expect_plausible(decoder, damaged, cloud)) continue;
    // What still decodes is one of the sound frames, with bytes behind it or none.
    const std::size_t size = decoder.last_header().frame_size;
    damaged.resize(size);
    EXPECT_NE(std::find(frames.begin(), frames.end(), damaged), frames.end()) << "mutation " << i;
  }
}

TEST(Mutation, ParsersBehindTheChecksumsHold) {
  std::mt19937 random(2);
  const std::vector<Bytes> frames = sound_frames();
  Decoder decoder;
  PointCloud cloud;
  int decoded = 0;
  for (int i = 0; i < 10000; ++i) {
    Bytes damaged = frames[random_bits(random) % frames.size()];
    mutate(random, frames, damaged);
    fuzz::repair_checksums(damaged);
    decoded += expect_plausible(decoder, damaged, cloud) ? 1 : 0;
  }
  EXPECT_GT(decoded, 100);  // else the repair does not work
}

/// The unpacked parts of a frame.
struct Opened {
  FrameHeader header;
  std::vector<Bytes> parts;
};

Opened opened(const Bytes& frame) {
  Opened o;
  EXPECT_TRUE(parse_frame_header(frame, o.header).has_value());
  ZstdDecoder zstd;
  for (const FramePart& part : o.header.parts) {
    Bytes raw;
    EXPECT_TRUE(
        zstd.decode(std::span(frame).subspan(part.offset, part.size), 1 << 22, raw).has_value());
    o.parts.push_back(raw);
  }
  return o;
}

Bytes closed(const Opened& o) {
  ZstdEncoder zstd(1);
  PartList parts;
  for (std::size_t i = 0; i < o.parts.size(); ++i) {
    parts.begin(o.header.parts[i].kind);
    zstd.append(o.parts[i], parts.bytes());
  }
  Bytes frame;
  write_frame(o.header.codec, {}, o.header.counts, parts, frame);
  return frame;
}

TEST(Mutation, ParsersBehindThePackingHold) {
  // The bytes of parts are damaged before they are packed: nothing but their parsers can object.
  std::mt19937 random(3);
  std::vector<Opened> sound;
  std::vector<std::vector<Bytes>> by_part(4);
  for (const Bytes& frame : sound_frames()) {
    sound.push_back(opened(frame));
    ASSERT_EQ(sound.back().parts.size(), 4U);
    for (std::size_t k = 0; k < 4; ++k) by_part[k].push_back(sound.back().parts[k]);
  }
  Decoder decoder;
  PointCloud cloud;
  int decoded = 0;
  for (int i = 0; i < 10000; ++i) {
    Opened damaged = sound[random_bits(random) % sound.size()];
    const std::size_t part = random_bits(random) % 4;
    mutate(random, by_part[part], damaged.parts[part]);
    if (random_bits(random) % 4 == 0)
      damaged.header.counts.points_coded = random_bits(random) % 3000;
    decoded += expect_plausible(decoder, closed(damaged), cloud) ? 1 : 0;
  }
  EXPECT_GT(decoded, 100);
}

}  // namespace
}  // namespace sweepcast
