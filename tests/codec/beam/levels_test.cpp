// Levels and budgets of bytes: what is left out, filled and counted.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "codec/beam/sensor.hpp"
#include "lab/distortion.hpp"
#include "lab/real_sweeps.hpp"

namespace sweepcast {
namespace {

using test::Bytes;

EncoderOptions level_options(int level) {
  EncoderOptions options = test::beam_options(0.05);
  options.beam.level = level;
  options.beam.fields = Fields::xyz;
  return options;
}

EncoderOptions budget_options(std::size_t bytes) {
  EncoderOptions options = test::beam_options(0.05);
  options.beam.target_bytes = bytes;
  options.beam.fields = Fields::xyz;
  return options;
}

PointCloud decode_filled(const Bytes& frame) {
  Decoder decoder({.fill = true});
  PointCloud cloud;
  EXPECT_TRUE(decoder.decode(frame, cloud).has_value());
  return cloud;
}

/// The frame's bytes without the sensor model: those of a frame that has no model part.
std::size_t size_without_model(const Bytes& frame) {
  FrameHeader header;
  EXPECT_TRUE(parse_frame_header(frame, header).has_value());
  std::size_t size = frame.size();
  for (const FramePart& part : header.parts) {
    if (part_name(header.codec, part.kind) != "model") continue;
    const std::size_t entry = 1 + (part.size < 128 ? 1 : 2) + 4;
    size -= part.size + entry;
  }
  return size;
}

TEST(BeamLevels, EachIsSmallerThanTheOneBeforeAndCountsAddUp) {
  const PointCloud cloud = test::spinning_sweep(32, 900, 1);
  std::size_t before = cloud.size();
  for (int level = 0; level < static_cast<int>(kBeamLevels.size()); ++level) {
    SCOPED_TRACE(level);
    Encoder encoder = test::encoder_of(level_options(level));
    const Bytes frame = test::encode(encoder, cloud);
    EXPECT_LT(100 * frame.size(), 102 * before);
    before = frame.size();
    const SweepCounts& counts = encoder.last_counts();
    EXPECT_EQ(test::sum_without_input(counts), cloud.size());
    EXPECT_EQ(counts.points_coded, test::decode(frame).size());
    EXPECT_EQ(counts.thinned > 0, level >= 2);
    FrameHeader header;
    ASSERT_TRUE(parse_frame_header(frame, header).has_value());
    EXPECT_EQ(header.counts, counts);
  }
}

TEST(BeamLevels, TheFirstTwoKeepEveryPointWithinTheirBound) {
  const PointCloud cloud = test::spinning_sweep(32, 900, 2);
  for (const auto& [level, bound] : {std::pair{0, 0.02}, {1, 0.05}}) {
    Encoder encoder = test::encoder_of(level_options(level));
    const Bytes frame = test::encode(encoder, cloud);
    test::expect_kept(cloud, test::decode(frame), encoder.last_counts(), bound);
  }
}

TEST(BeamLevels, FilledPointsAreMarkedAndNearWhatWasLeftOut) {
  const PointCloud cloud = test::spinning_sweep(32, 900, 3);
  Encoder encoder = test::encoder_of(level_options(3));
  const Bytes frame = test::encode(encoder, cloud);
  const PointCloud measured = test::decode(frame);
  const PointCloud filled = decode_filled(frame);
  EXPECT_TRUE(measured.filled.empty());
  ASSERT_EQ(filled.filled.size(), filled.size());
  for (std::size_t i = 0; i < filled.size(); ++i) {
    EXPECT_EQ(filled.filled[i], i < measured.size() ? 0 : 1);
  }
  EXPECT_GT(filled.size(), measured.size() + cloud.size() / 4);
  // Most of the sweep is smooth: what interpolation gives lies near what was measured.
  const auto coarse = lab::Reference(cloud).compare(measured);
  const auto full = lab::Reference(cloud).compare(filled);
  EXPECT_GT(full.f_score[2], coarse.f_score[2]);
  EXPECT_GT(full.f_score[2], 95.0);
}

TEST(BeamLevels, LonePointsFarFromAllOthersAreKept) {
  PointCloud cloud = test::spinning_sweep(32, 900, 5);
  // Every 150th point at a fraction of its range: specks in the air.
  std::vector<std::size_t> specks;
  for (std::size_t i = 75; i < cloud.size(); i += 150) {
    const float range = std::hypot(cloud.x[i], cloud.y[i], cloud.z[i]);
    if (range < 12.0F) continue;
    const float share = 6.0F / range;
    cloud.x[i] *= share;
    cloud.y[i] *= share;
    cloud.z[i] *= share;
    specks.push_back(i);
  }
  ASSERT_GT(specks.size(), 10U);
  Encoder encoder = test::encoder_of(level_options(5));
  const Bytes frame = test::encode(encoder, cloud);
  EXPECT_EQ(test::sum_without_input(encoder.last_counts()), cloud.size());
  const PointCloud decoded = test::decode(frame);
  for (const std::size_t i : specks) {
    double nearest = 1e9;
    for (std::size_t k = 0; k < decoded.size(); ++k) {
      nearest =
          std::min<double>(nearest, std::hypot(decoded.x[k] - cloud.x[i], decoded.y[k] - cloud.y[i],
                                               decoded.z[k] - cloud.z[i]));
    }
    EXPECT_LT(nearest, 2.3) << i;  // 8 of the last layer's steps, and half a step
  }
}

TEST(BeamLevels, AFrameWithEveryPointHasNothingToFill) {
  const PointCloud cloud = test::spinning_sweep(16, 400, 4);
  Encoder encoder = test::encoder_of(level_options(1));
  const Bytes frame = test::encode(encoder, cloud);
  EXPECT_EQ(decode_filled(frame).size(), test::decode(frame).size());
}

// A made-up hall has few kinds of surface, which a level leaves out all at once: its sizes jump.
TEST(BeamBudget, NoFrameIsLargerAndMostComeNear) {
  for (const std::size_t bytes : {1'500U, 3'000U, 6'000U, 15'000U}) {
    Encoder encoder = test::encoder_of(budget_options(bytes));
    int close = 0;
    constexpr int kSweeps = 20;
    for (int i = 0; i < kSweeps; ++i) {
      const PointCloud cloud =
          test::spinning_sweep(32, 900, static_cast<std::uint32_t>(10 + i), 0.1 * i);
      const std::size_t size = size_without_model(test::encode(encoder, cloud));
      EXPECT_LE(size, bytes) << i;
      close += 100 * size >= 97 * bytes ? 1 : 0;
    }
    EXPECT_GE(close, kSweeps / 2) << bytes;
  }
}

TEST(BeamBudget, PlentyOfBytesKeepEveryPoint) {
  std::mt19937 random(3);
  Encoder encoder = test::encoder_of(budget_options(30'000));
  for (int i = 0; i < 6; ++i) {
    PointCloud cloud = test::spinning_sweep(32, 900, static_cast<std::uint32_t>(50 + i));
    for (auto* column : {&cloud.x, &cloud.y, &cloud.z}) {  // off the beams by up to 4 mm
      for (float& x : *column) x += static_cast<float>(test::uniform(random, -0.004, 0.004));
    }
    EXPECT_LE(size_without_model(test::encode(encoder, cloud)), 30'000U) << i;
    EXPECT_EQ(encoder.last_counts().points_coded, cloud.size()) << i;
  }
}

TEST(BeamBudget, RealSweepsLandWithinThreePerCentBelow) {
  const auto paths = lab::real_sweeps("kitti_0048");
  if (paths.empty()) GTEST_SKIP() << "set SWEEPCAST_DATA to a folder with kitti_0048";
  for (const std::size_t bytes : {6'000U, 20'000U}) {
    Encoder encoder = test::encoder_of(budget_options(bytes));
    std::size_t close = 0;
    for (const auto& path : paths) {
      const std::size_t size = size_without_model(test::encode(encoder, lab::read_kitti(path)));
      EXPECT_LE(size, bytes) << path;
      close += 100 * size >= 97 * bytes ? 1U : 0U;
    }
    EXPECT_GE(100 * close, 95 * paths.size()) << bytes;
  }
}

TEST(BeamBudget, SaysThatASweepCannotFit) {
  Encoder encoder = test::encoder_of(budget_options(60));
  const PointCloud cloud = test::spinning_sweep(32, 900, 5);
  const auto frame = encoder.encode(CloudView(cloud), {});
  ASSERT_FALSE(frame.has_value());
  EXPECT_EQ(frame.error().code, ErrorCode::limit);
  EXPECT_NE(frame.error().message.find("60 bytes"), std::string::npos);
}

TEST(BeamBudget, ASmallSweepTakesWhatItNeeds) {
  const PointCloud cloud = test::spinning_sweep(16, 100, 6);
  Encoder encoder = test::encoder_of(budget_options(1'000'000));
  const Bytes frame = test::encode(encoder, cloud);
  test::expect_kept(cloud, test::decode(frame), encoder.last_counts(), 0.01);
}

TEST(BeamOptions, OneQualityAtATime) {
  EncoderOptions options = level_options(1);
  options.beam.target_bytes = 1'000;
  EXPECT_FALSE(Encoder::create(options).has_value());
  options = level_options(6);
  EXPECT_FALSE(Encoder::create(options).has_value());
  options = budget_options(1'000);
  options.beam.lossless = true;
  EXPECT_FALSE(Encoder::create(options).has_value());
}

struct Row {
  int level;
  double ratio, f5, f10, d1, d2;
};

// What the levels are for, on KITTI's five sweeps, filled.
TEST(BeamLevels, OnKitti) {
  const auto paths = lab::real_sweeps("kitti_hdl64");
  if (paths.empty()) GTEST_SKIP() << "set SWEEPCAST_DATA to a folder with kitti_hdl64";
  constexpr std::array<Row, 3> kRows{
      {{2, 98, 95, 98, 66, 73.5}, {4, 200, 75, 93, 60.5, 68.5}, {5, 300, 73, 88, 56.5, 65}}};
  for (const Row& row : kRows) {
    SCOPED_TRACE(row.level);
    Encoder encoder = test::encoder_of(level_options(row.level));
    Decoder decoder({.fill = true});
    double points = 0, bytes = 0, f5 = 0, f10 = 0, d1 = 0, d2 = 0;
    for (const auto& path : paths) {
      const PointCloud cloud = lab::read_kitti(path);
      const Bytes frame = test::encode(encoder, cloud);
      PointCloud decoded;
      ASSERT_TRUE(decoder.decode(frame, decoded).has_value());
      const lab::Distortion distortion = lab::Reference(cloud).compare(decoded);
      points += static_cast<double>(cloud.size());
      bytes += static_cast<double>(frame.size());
      f5 += distortion.f_score[1] / 5;
      f10 += distortion.f_score[2] / 5;
      d1 += distortion.d1_psnr / 5;
      d2 += distortion.d2_psnr / 5;
    }
    EXPECT_GE(16 * points / bytes, row.ratio);
    EXPECT_GE(f5, row.f5);
    EXPECT_GE(f10, row.f10);
    EXPECT_GE(d1, row.d1);
    EXPECT_GE(d2, row.d2);
  }
}

}  // namespace
}  // namespace sweepcast
