// Codec beam from end to end on simulated sweeps.
#include <gtest/gtest.h>

#include <limits>

#include "codec/beam/codec.hpp"
#include "codec/beam/sensor.hpp"
#include "rounds.hpp"

namespace sweepcast {
namespace {

using test::Bytes;
using test::uniform;

constexpr double kErrors[] = {0.01, 0.05, 0.4};

FrameHeader header_of(const Bytes& frame) {
  FrameHeader header;
  EXPECT_TRUE(parse_frame_header(frame, header).has_value());
  return header;
}

bool has_part(const Bytes& frame, beam::Part part) {
  const FrameHeader header = header_of(frame);
  return std::any_of(header.parts.begin(), header.parts.end(),
                     [&](const FramePart& p) { return p.kind == static_cast<std::uint8_t>(part); });
}

/// Encodes and decodes with fresh ends and checks that every point is kept; gives the frame.
Bytes expect_round_trip(const PointCloud& cloud, double max_error_m) {
  SCOPED_TRACE("max error " + std::to_string(max_error_m));
  Encoder encoder = test::encoder_of(test::beam_options(max_error_m));
  const Bytes frame = test::encode(encoder, cloud);
  EXPECT_EQ(header_of(frame).counts, encoder.last_counts());
  test::expect_kept(cloud, test::decode(frame), encoder.last_counts(), max_error_m);
  return frame;
}

TEST(BeamCodec, ACleanSensorsSweepIsKeptWithinTheBound) {
  const PointCloud cloud = test::spinning_sweep(32, 1800, 1);
  std::size_t larger = std::numeric_limits<std::size_t>::max();
  for (const double max_error : kErrors) {
    const Bytes frame = expect_round_trip(cloud, max_error);
    // Under wider bounds the points crowd, and an octree may take them without a model.
    EXPECT_TRUE(max_error > 0.01 || has_part(frame, beam::Part::model))
        << "the sensor's model was not found at " << max_error;
    EXPECT_LT(frame.size() * 20, cloud.size() * 16);
    EXPECT_LT(frame.size(), larger);
    larger = frame.size();
  }
}

TEST(BeamCodec, PointsThatCannotBeCodedAreCounted) {
  PointCloud cloud = test::spinning_sweep(32, 900, 2);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  test::add_point(cloud, nan, 1, 2);
  test::add_point(cloud, 1, infinite, 2);
  test::add_point(cloud, 1, 2, -infinite);
  for (int i = 0; i < 10; ++i) test::add_point(cloud, 0, 0, 0);
  const std::size_t before = cloud.size();
  for (std::size_t i = 0; i < before; i += 50) {  // duplicates, among them of the uncodable
    test::add_point(cloud, cloud.x[i], cloud.y[i], cloud.z[i]);
  }
  test::add_point(cloud, 0.05, 0.02, 0.01);  // at the sensor's very centre
  test::add_point(cloud, -0.001, 0, 0);
  for (const double max_error : kErrors) {
    Encoder encoder = test::encoder_of(test::beam_options(max_error));
    const Bytes frame = test::encode(encoder, cloud);
    const SweepCounts& counts = encoder.last_counts();
    EXPECT_GE(counts.not_finite, 3U);
    EXPECT_GE(counts.zero_range, 10U);
    test::expect_kept(cloud, test::decode(frame), counts, max_error);
  }
}

TEST(BeamCodec, PointsBeyondTheLatticeAreCounted) {
  PointCloud cloud;
  test::add_point(cloud, 1e6, 0, 0);
  test::add_point(cloud, 3, -1e30, 0);
  test::add_point(cloud, 3e38, 3e38, -3e38);
  test::add_point(cloud, 3, 4, 5);
  Encoder encoder = test::encoder_of(test::beam_options(0.01));
  const PointCloud decoded = test::decode(test::encode(encoder, cloud));
  EXPECT_EQ(decoded.size(), 1U);
  EXPECT_EQ(encoder.last_counts().out_of_view, 3U);
  EXPECT_EQ(test::sum_without_input(encoder.last_counts()), 4U);
}

TEST(BeamCodec, CroppedPointsAreCounted) {
  const PointCloud cloud = test::spinning_sweep(32, 900, 3);
  EncoderOptions options = test::beam_options(0.05);
  options.crop.min_range = 5.0F;
  options.crop.max_range = 12.0F;
  Encoder encoder = test::encoder_of(options);
  const PointCloud decoded = test::decode(test::encode(encoder, cloud));
  PointCloud kept;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float range =
        std::sqrt(cloud.x[i] * cloud.x[i] + cloud.y[i] * cloud.y[i] + cloud.z[i] * cloud.z[i]);
    if (range >= 5.0F && range <= 12.0F) test::add_point(kept, cloud.x[i], cloud.y[i], cloud.z[i]);
  }
  ASSERT_GT(kept.size(), 1000U);
  EXPECT_EQ(decoded.size(), kept.size());
  EXPECT_EQ(encoder.last_counts().cropped, cloud.size() - kept.size());
  EXPECT_LE(test::worst_distance(kept, decoded, 0.05001), 0.05001);
}

TEST(BeamCodec, ACloudOfNoSensorIsKeptWithinTheBound) {
  std::mt19937 random(4);
  PointCloud cloud;
  for (int i = 0; i < test::rounds(20'000); ++i) {
    test::add_point(cloud, uniform(random, -60, 60), uniform(random, -60, 60),
                    uniform(random, -5, 20));
  }
  for (const double max_error : kErrors) expect_round_trip(cloud, max_error);
}

TEST(BeamCodec, FewPointsAndNone) {
  for (const int count : {0, 1, 2, 100}) {
    std::mt19937 random(5);
    PointCloud cloud;
    for (int i = 0; i < count; ++i) {
      test::add_point(cloud, uniform(random, -9, 9), uniform(random, -9, 9), uniform(random, 1, 2));
    }
    for (const double max_error : {0.001, 0.05, 2.0}) {
      EXPECT_LT(expect_round_trip(cloud, max_error).size(), 60U + 16U * cloud.size());
    }
  }
}

/// Walls at 5.6 and 3.6 m: within 10 cm, many points share a place.
PointCloud small_room(std::uint32_t seed) {
  return test::spinning_sweep(32, 1200, seed, 0.0, 0.4);
}

TEST(BeamCodec, ASmallRoomIsCodedAsAnOctree) {
  const PointCloud room = small_room(1);
  Encoder encoder = test::encoder_of(test::beam_options(0.1));
  const Bytes frame = test::encode(encoder, room);
  EXPECT_FALSE(has_part(frame, beam::Part::model));
  EXPECT_FALSE(has_part(frame, beam::Part::layer));
  test::expect_kept(room, test::decode(frame), encoder.last_counts(), 0.1);
  // Coded as an image, which one may insist on.
  EncoderOptions fast = test::beam_options(0.1);
  fast.beam.effort = Effort::fast;
  Encoder imager = test::encoder_of(fast);
  const Bytes image = test::encode(imager, room);
  EXPECT_TRUE(has_part(image, beam::Part::layer));
  EXPECT_LT(frame.size() * 3, image.size() * 2);
}

TEST(BeamCodec, AStreetIsCodedAsAnImage) {
  const Bytes frame = expect_round_trip(test::spinning_sweep(32, 1200, 1), 0.05);
  EXPECT_TRUE(has_part(frame, beam::Part::layer));
  for (const FramePart& part : header_of(frame).parts) {
    const bool extras = part.kind == static_cast<std::uint8_t>(beam::Part::extras);
    EXPECT_LT(part.size, extras ? 200U : frame.size());
  }
}

TEST(BeamCodec, TheModelComesWithTheFirstImageAfterASmallRoom) {
  Encoder encoder = test::encoder_of(test::beam_options(0.1));
  Decoder decoder;
  PointCloud cloud;
  int models = 0;
  for (std::uint32_t i = 0; i < 22; ++i) {
    SCOPED_TRACE(i);
    const PointCloud sweep = i < 5 ? small_room(i) : test::spinning_sweep(32, 1200, i);
    const Bytes frame = test::encode(encoder, sweep, {i, 0, "s"});
    const bool image = has_part(frame, beam::Part::layer);
    EXPECT_FALSE(image && i < 5);
    EXPECT_TRUE(image || i < 10) << "the choice was not reviewed";
    EXPECT_TRUE(image || !has_part(frame, beam::Part::model));
    models += has_part(frame, beam::Part::model) ? 1 : 0;
    ASSERT_TRUE(decoder.decode(frame, cloud).has_value());
    test::expect_kept(sweep, cloud, encoder.last_counts(), 0.1);
  }
  EXPECT_EQ(models, 2);
}

TEST(BeamCodec, OptionsOutsideTheirBoundsAreRefused) {
  for (const double error : {0.0, 0.0009, 2.1, -1.0, std::nan("")}) {
    EXPECT_FALSE(Encoder::create(test::beam_options(error)).has_value()) << error;
  }
  EXPECT_FALSE(Encoder::create(test::beam_options(0.05, 0)).has_value());
  EXPECT_TRUE(Encoder::create(test::beam_options(2.0, 1)).has_value());
}

/// Ten sweeps of a sensor that drives through its hall, and their frames.
struct Drive {
  std::vector<PointCloud> sweeps;
  std::vector<Bytes> frames;
  std::vector<SweepCounts> counts;
};

Drive drive(int model_interval) {
  Drive d;
  Encoder encoder = test::encoder_of(test::beam_options(0.05, model_interval));
  for (std::uint32_t i = 0; i < 10; ++i) {
    d.sweeps.push_back(test::spinning_sweep(32, 600, 10 + i, 0.3 * i));
    d.frames.push_back(test::encode(encoder, d.sweeps.back(), {i, 0, "s"}));
    d.counts.push_back(encoder.last_counts());
  }
  return d;
}

TEST(BeamCodec, ModelComesEveryFewFrames) {
  for (const int interval : {1, 4, 10}) {
    const Drive d = drive(interval);
    for (std::size_t i = 0; i < d.frames.size(); ++i) {
      EXPECT_EQ(has_part(d.frames[i], beam::Part::model),
                i % static_cast<std::size_t>(interval) == 0)
          << "frame " << i << ", interval " << interval;
    }
  }
}

TEST(BeamCodec, ADecoderFromTheStartDecodesAll) {
  const Drive d = drive(4);
  Decoder decoder;
  PointCloud cloud;
  for (std::size_t i = 0; i < d.frames.size(); ++i) {
    SCOPED_TRACE(i);
    ASSERT_TRUE(decoder.decode(d.frames[i], cloud).has_value());
    test::expect_kept(d.sweeps[i], cloud, d.counts[i], 0.05);
    EXPECT_EQ(decoder.last_header().sequence, i);
  }
}

TEST(BeamCodec, ADecoderThatJoinsLateWaitsForTheModel) {
  const Drive d = drive(4);
  Decoder decoder;
  PointCloud cloud;
  test::add_point(cloud, 1, 1, 1);
  for (std::size_t i = 1; i < d.frames.size(); ++i) {
    SCOPED_TRACE(i);
    const Status status = decoder.decode(d.frames[i], cloud);
    if (i < 4) {
      ASSERT_FALSE(status.has_value());
      EXPECT_EQ(status.error().code, ErrorCode::unsupported);
      EXPECT_NE(status.error().message.find("sensor model"), std::string::npos);
      EXPECT_TRUE(cloud.empty() && cloud.y.empty() && cloud.z.empty());
    } else {
      ASSERT_TRUE(status.has_value()) << status.error().message;
      test::expect_kept(d.sweeps[i], cloud, d.counts[i], 0.05);
    }
  }
}

TEST(BeamCodec, TheModelOfAnotherSensorIsNotTaken) {
  const Drive d = drive(4);
  Encoder other = test::encoder_of(test::beam_options(0.05));
  const Bytes frame = test::encode(other, test::spinning_sweep(16, 900, 8));
  ASSERT_TRUE(has_part(frame, beam::Part::model));
  Decoder decoder;
  PointCloud cloud;
  ASSERT_TRUE(decoder.decode(frame, cloud).has_value());
  const Status status = decoder.decode(d.frames[1], cloud);
  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code, ErrorCode::unsupported);
}

TEST(BeamCodec, SameSweepsGiveSameBytes) {
  EXPECT_EQ(drive(4).frames, drive(4).frames);
}

TEST(BeamCodec, FramesCutBetweenLayersDecode) {
  const PointCloud sweep = test::spinning_sweep(32, 900, 9);
  const Bytes frame = test::encode(test::beam_options(0.05), sweep);
  const FrameHeader header = header_of(frame);
  std::size_t fewer = 0;
  int layer = 0;
  for (const FramePart& part : header.parts) {
    if (part.kind < static_cast<std::uint8_t>(beam::Part::layer)) continue;
    ++layer;
    SCOPED_TRACE(layer);
    const Bytes cut(frame.begin(),
                    frame.begin() + static_cast<std::ptrdiff_t>(part.offset + part.size));
    const PointCloud cloud = test::decode(cut);
    EXPECT_GT(cloud.size(), fewer);
    fewer = cloud.size();
    EXPECT_LE(test::worst_distance(cloud, sweep, 0.05001), 0.05001);

    DecoderOptions options;
    options.max_layers = layer;
    PointCloud first_layers;
    ASSERT_TRUE(Decoder(options).decode(frame, first_layers).has_value());
    EXPECT_EQ(first_layers.x, cloud.x);
    EXPECT_EQ(first_layers.y, cloud.y);
    EXPECT_EQ(first_layers.z, cloud.z);

    // Cut within the next layer, the layers before count.
    if (part.offset + part.size < frame.size()) {
      const Bytes within(frame.begin(),
                         frame.begin() + static_cast<std::ptrdiff_t>(part.offset + part.size + 1));
      EXPECT_EQ(test::decode(within).size(), cloud.size());
    }
  }
  EXPECT_EQ(layer, 5);
  EXPECT_EQ(fewer, sweep.size());
}

TEST(BeamCodec, FramesCutWithinTheFirstLayerAreTruncated) {
  const Bytes frame = test::encode(test::beam_options(0.05), test::spinning_sweep(32, 900, 9));
  const FrameHeader header = header_of(frame);
  const auto first = std::find_if(header.parts.begin(), header.parts.end(), [](const FramePart& p) {
    return p.kind == static_cast<std::uint8_t>(beam::Part::layer);
  });
  ASSERT_NE(first, header.parts.end());
  for (std::size_t size = 4; size < first->offset + first->size; size += size < 200 ? 1 : 37) {
    const Bytes cut(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(size));
    PointCloud cloud;
    const Status status = Decoder().decode(cut, cloud);
    ASSERT_FALSE(status.has_value()) << size;
    EXPECT_EQ(status.error().code, ErrorCode::truncated) << size << ": " << status.error().message;
    EXPECT_TRUE(cloud.empty());
  }
}

TEST(BeamCodec, ADecoderGivesNoMorePointsThanItMay) {
  const PointCloud sweep = test::spinning_sweep(32, 900, 9);
  const Bytes frame = test::encode(test::beam_options(0.05), sweep);
  DecoderOptions options;
  options.max_points = sweep.size() - 1;
  PointCloud cloud;
  const Status status = Decoder(options).decode(frame, cloud);
  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code, ErrorCode::limit);
}

}  // namespace
}  // namespace sweepcast
