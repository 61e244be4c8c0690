// Damaged frames of codec beam, their checksums made right: an error and no cloud, or a cloud.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "codec/beam/codec.hpp"
#include "codec/beam/model_bytes.hpp"
#include "codec/beam/octree.hpp"
#include "codec/beam/sensor.hpp"
#include "codec/damage.hpp"
#include "codec/frame_layout.hpp"
#include "core/crc32.hpp"
#include "repair_frame.hpp"
#include "rounds.hpp"

namespace sweepcast {
namespace {

using test::Bytes;
using test::mutate;
using test::random_bits;
using test::uniform_int;

std::vector<Bytes> sound_frames() {
  std::vector<Bytes> frames;
  for (const double max_error : {0.01, 0.2}) {
    Encoder encoder = test::encoder_of(test::beam_options(max_error, 2));
    for (std::uint32_t i = 0; i < 3; ++i) {
      frames.push_back(test::encode(encoder, test::spinning_sweep(12, 300, i), {i, 0, "s"}));
    }
  }
  EncoderOptions everything = test::beam_options(0.1);
  everything.beam.keep_order = true;
  everything.beam.lossless = true;
  std::mt19937 random(7);
  PointCloud whole = test::spinning_sweep(12, 200, 4);
  whole.resize_xyz(whole.size() / 8 * 8);
  whole.width = 8;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    whole.intensity.push_back(static_cast<float>(uniform_int(random, 0, 99)));
    whole.ring.push_back(static_cast<std::uint16_t>(i % 12));
    whole.time_ns.push_back(static_cast<std::int64_t>(i) * 2304 + uniform_int(random, 0, 2));
  }
  frames.push_back(test::encode(everything, whole));
  for (float& intensity : whole.intensity) intensity = std::sin(intensity);
  whole.width = 0;
  frames.push_back(test::encode(everything, whole));
  for (float& intensity : whole.intensity)
    intensity = static_cast<float>(uniform_int(random, 0, 1 << 30)) * 1e-3F;
  frames.push_back(test::encode(everything, whole));
  PointCloud strays;
  for (int i = 0; i < 200; ++i) {
    test::add_point(strays, uniform_int(random, -9, 9), uniform_int(random, -9, 9), 1);
  }
  frames.push_back(test::encode(test::beam_options(0.05), strays));
  return frames;
}

bool expect_plausible(Decoder& decoder, const Bytes& frame, PointCloud& cloud) {
  const Status status = decoder.decode(frame, cloud);
  EXPECT_EQ(cloud.y.size(), cloud.size());
  EXPECT_EQ(cloud.z.size(), cloud.size());
  if (status) {
    EXPECT_LE(cloud.size(), decoder.last_header().counts.points_coded);
    return true;
  }
  EXPECT_TRUE(cloud.empty());
  EXPECT_FALSE(status.error().message.empty());
  return false;
}

TEST(BeamMutation, ChecksumsFindTheDamage) {
  std::mt19937 random(1);
  const std::vector<Bytes> frames = sound_frames();
  PointCloud cloud;
  for (int i = 0; i < test::rounds(3000); ++i) {
    const Bytes& sound = frames[random_bits(random) % frames.size()];
    Bytes damaged = sound;
    damaged[random_bits(random) % damaged.size()] ^= static_cast<std::byte>(1U << (i % 8));
    Decoder decoder;
    EXPECT_FALSE(expect_plausible(decoder, damaged, cloud)) << i;
  }
}

TEST(BeamMutation, ParsersBehindTheChecksumsHold) {
  std::mt19937 random(2);
  const std::vector<Bytes> frames = sound_frames();
  DecoderOptions options;
  options.max_points = 1 << 20;
  Decoder decoder(options);
  PointCloud cloud;
  int decoded = 0;
  for (int i = 0; i < 3000; ++i) {
    Bytes damaged = frames[random_bits(random) % frames.size()];
    mutate(random, frames, damaged);
    fuzz::repair_checksums(damaged);
    decoded += expect_plausible(decoder, damaged, cloud) ? 1 : 0;
  }
  EXPECT_GT(decoded, 100);  // else the repair does not work
}

/// A frame of these parts, its checksums right.
Bytes frame_of(const std::vector<std::pair<beam::Part, Bytes>>& contents, std::uint32_t points) {
  PartList parts;
  for (const auto& [kind, bytes] : contents) {
    parts.begin(static_cast<std::uint8_t>(kind));
    parts.bytes().insert(parts.bytes().end(), bytes.begin(), bytes.end());
  }
  SweepCounts counts;
  counts.points_coded = points;
  Bytes frame;
  write_frame(CodecId::beam, {}, counts, parts, frame);
  return frame;
}

Bytes numbers(std::initializer_list<std::uint64_t> values) {
  Bytes bytes;
  ByteWriter out(bytes);
  for (const std::uint64_t value : values) out.put_varint(value);
  return bytes;
}

TEST(BeamMutation, ExtrasThatTheBytesCannotHoldAreRefused) {
  for (const std::uint64_t count :
       {std::uint64_t{1} << 20, std::uint64_t{1} << 24, std::uint64_t{1} << 40}) {
    Bytes extras = numbers({count, 100});
    for (int i = 0; i < 40; ++i) extras.push_back(static_cast<std::byte>(i * 37));
    const Bytes frame =
        frame_of({{beam::Part::grid, numbers({0})}, {beam::Part::extras, extras}}, 10);
    PointCloud cloud;
    const Status status = Decoder().decode(frame, cloud);
    EXPECT_FALSE(status.has_value()) << count;
    EXPECT_TRUE(cloud.empty());
  }
}

/// A frame whose image has so many cells that its few bytes cannot fill them.
Bytes huge_image(int beams, std::int32_t ticks, int base) {
  SensorModel model;
  model.ticks_per_turn = ticks;
  for (int k = 0; k < beams; ++k) model.beams.push_back({1000 - k, 0, 0, 0, 0});
  Bytes model_bytes;
  ByteWriter model_out(model_bytes);
  beam::write_model(model, model_out);
  std::vector<std::int32_t> firing_ticks(static_cast<std::size_t>(ticks));
  std::iota(firing_ticks.begin(), firing_ticks.end(), 0);
  Bytes firings;
  beam::FiringCoder().write(firing_ticks, firings);
  Bytes grid;
  ByteWriter grid_out(grid);
  grid_out.put_varint(static_cast<std::uint64_t>(ticks));
  grid_out.put(crc32(model_bytes));
  grid_out.put(static_cast<std::uint8_t>(Effort::normal));
  grid_out.put(static_cast<std::uint8_t>(base));
  grid_out.put(static_cast<std::uint8_t>(base));
  for (int stride = base; stride > 0; stride /= 2) {
    grid_out.put_varint(988);
    grid_out.put_signed(-1);
  }
  for (int zeros = 0; zeros < 3; ++zeros) grid_out.put(std::uint8_t{0});
  const Bytes layer(20, std::byte{85});
  return frame_of({{beam::Part::model, model_bytes},
                   {beam::Part::grid, grid},
                   {beam::Part::firings, firings},
                   {beam::Part::layer, layer}},
                  10);
}

TEST(BeamMutation, ImagesThatTheBytesCannotHoldAreRefused) {
  // Margins count: those of one beam's image are most of it.
  for (const auto& [beams, ticks, base] : {std::tuple{16, 1 << 20, 1},
                                           {16, 1 << 20, 16},
                                           {1, 1 << 20, 16},
                                           {1024, 1 << 14, 1},
                                           {1024, 1 << 20, 4}}) {
    const Bytes frame = huge_image(beams, ticks, base);
    EXPECT_LT(frame.size(), 20'000U);
    PointCloud cloud;
    const Status status = Decoder().decode(frame, cloud);
    ASSERT_FALSE(status.has_value());
    EXPECT_EQ(status.error().code, ErrorCode::corrupt);
    EXPECT_TRUE(cloud.empty());
  }
}

TEST(BeamMutation, MorePointsThanAnnouncedAreRefused) {
  std::vector<beam::LatticePoint> points(50, {1, 2, 3});
  Bytes extras = numbers({points.size(), 100});
  beam::OctreeCoder().write(points, extras);
  const auto decode = [&](std::uint32_t announced) {
    PointCloud cloud;
    const Bytes frame =
        frame_of({{beam::Part::grid, numbers({0})}, {beam::Part::extras, extras}}, announced);
    return Decoder().decode(frame, cloud).has_value();
  };
  EXPECT_TRUE(decode(50));
  EXPECT_FALSE(decode(49));
}

}  // namespace
}  // namespace sweepcast
