// The encoder and the decoder as a user sees them.
#include "sweepcast/encoder.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <utility>

#include "codec/scene.hpp"

namespace sweepcast {
namespace {

using test::add_point;
using test::Bytes;
using test::decode;
using test::encode;
using test::encoder_of;
using test::street;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Coded {
  PointCloud cloud;
  SweepCounts counts;
};

/// Encodes and decodes; what must hold for any cloud and any options is checked.
Coded round_trip(const EncoderOptions& options, const PointCloud& cloud) {
  Encoder encoder = encoder_of(options);
  const Bytes frame = encode(encoder, cloud, {3, 4, "s"});
  Coded coded;
  Decoder decoder;
  const Status status = decoder.decode(frame, coded.cloud);
  EXPECT_TRUE(status.has_value()) << status.error().message;
  coded.counts = decoder.last_header().counts;
  EXPECT_EQ(coded.counts, encoder.last_counts());
  EXPECT_EQ(coded.counts.points_in, cloud.size());
  EXPECT_EQ(test::sum_without_input(coded.counts), cloud.size());
  EXPECT_EQ(coded.cloud.size(), coded.counts.points_coded);
  EXPECT_EQ(decoder.last_header().sequence, 3U);
  EXPECT_EQ(decoder.last_header().stamp_ns, 4);
  EXPECT_EQ(decoder.last_header().sensor, "s");
  EXPECT_EQ(decoder.last_header().frame_size, frame.size());
  EXPECT_FALSE(coded.cloud.has_intensity() || coded.cloud.has_ring() || coded.cloud.has_time());
  for (std::size_t i = 0; i < coded.cloud.size(); ++i) {
    if (!std::isfinite(coded.cloud.x[i] + coded.cloud.y[i] + coded.cloud.z[i])) {
      ADD_FAILURE() << "point " << i << " is not finite";
      break;
    }
  }
  return coded;
}

double range_of(const PointCloud& cloud, std::size_t i) {
  return std::hypot(double{cloud.x[i]}, double{cloud.y[i]}, double{cloud.z[i]});
}

TEST(Encoder, AnEmptyCloudGivesAFrameOfNothing) {
  for (const EncoderOptions& options : test::all_options()) {
    EXPECT_TRUE(round_trip(options, {}).cloud.empty());
  }
}

TEST(Encoder, OnePointComesBack) {
  for (const EncoderOptions& options : test::all_options()) {
    PointCloud cloud;
    add_point(cloud, -12, 1, -2);
    const Coded coded = round_trip(options, cloud);
    ASSERT_EQ(coded.counts.points_coded, 1U);
    const RcpccParams& p = options.rcpcc.params;
    const double slack = options.rcpcc.rounding == Rounding::truncate ? 1.0 : 0.5;
    EXPECT_NEAR(range_of(coded.cloud, 0), range_of(cloud, 0), slack * p.quantiser_step_m + 0.001);
    // The row's offset places a lone point to 1/128 of a step.
    EXPECT_NEAR(std::atan2(coded.cloud.y[0], coded.cloud.x[0]), std::atan2(1, -12),
                p.azimuth_step_deg / 128 * std::numbers::pi / 180 + 1e-6);
  }
}

TEST(Encoder, CloudsWithoutACodablePointGiveEmptyClouds) {
  PointCloud cloud;
  for (int i = 0; i < 100; ++i) add_point(cloud, kNan, kNan, kNan);
  const Coded nan = round_trip({.codec = CodecId::rcpcc}, cloud);
  EXPECT_EQ(nan.counts.not_finite, 100U);
  EXPECT_TRUE(nan.cloud.empty());
  PointCloud zeros;
  zeros.resize_xyz(100);
  EXPECT_EQ(round_trip({.codec = CodecId::rcpcc}, zeros).counts.zero_range, 100U);
}

TEST(Encoder, DuplicatesCountAsCollided) {
  PointCloud cloud;
  for (int i = 0; i < 1000; ++i) add_point(cloud, 5, 5, 1);
  const Coded coded = round_trip({.codec = CodecId::rcpcc}, cloud);
  EXPECT_EQ(coded.counts.points_coded, 1U);
  EXPECT_EQ(coded.counts.collided, 999U);
}

TEST(Encoder, EveryOptionValueDecodesWithinItsErrors) {
  const PointCloud cloud = street(32, 900);
  for (const EncoderOptions& options : test::all_options()) {
    const Coded coded = round_trip(options, cloud);
    EXPECT_GT(coded.counts.points_coded, 100U);
    for (std::size_t i = 0; i < coded.cloud.size(); ++i) {
      // Within the street, whatever the options: its walls, its length, its floor and sky.
      const double slack = 1.0 + 2.5 * options.rcpcc.params.quantiser_step_m +
                           100 * options.rcpcc.params.azimuth_step_deg / 57;
      ASSERT_LT(std::abs(coded.cloud.y[i]), 7 + slack);
      ASSERT_LT(range_of(coded.cloud, i), 101 + slack);
      ASSERT_GT(coded.cloud.z[i], -1.8 - slack);
    }
  }
}

TEST(Encoder, ALonelyNearPointDisturbsNoOther) {
  // 5 cm from the sensor and above all beams, so that it comes back last.
  const PointCloud cloud = street(32, 900);
  PointCloud with = cloud;
  add_point(with, 0.035, 0.035, 0.005);
  for (const int level : {0, 1, 2, 3, 4, 5}) {
    EncoderOptions options;
    options.codec = CodecId::rcpcc;
    options.rcpcc.params = kRcpccLevels.at(static_cast<std::size_t>(level));
    const Coded a = round_trip(options, cloud);
    const Coded b = round_trip(options, with);
    ASSERT_EQ(b.cloud.size(), a.cloud.size() + 1);
    const RcpccParams& p = options.rcpcc.params;
    EXPECT_NEAR(range_of(b.cloud, a.cloud.size()), 0.05, 2 * p.quantiser_step_m);
    std::size_t changed = 0;
    for (std::size_t i = 0; i < a.cloud.size(); ++i) {
      const double off = std::abs(range_of(a.cloud, i) - range_of(b.cloud, i));
      changed += off > 0 ? 1 : 0;
      // What one way of coding a range and another may differ by.
      ASSERT_LE(off, 2 * std::max(p.threshold_m, 4 * p.quantiser_step_m));
    }
    EXPECT_LE(changed, 100U);  // its block, its run and its region, of 27000
  }
}

TEST(Encoder, PointsThatCannotBeCodedCostOnlyThemselves) {
  const PointCloud cloud = street(32, 900);
  PointCloud with;
  add_point(with, kInfinity, 1, 1);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    add_point(with, double{cloud.x[i]}, double{cloud.y[i]}, double{cloud.z[i]});
    if (i % 997 == 0) add_point(with, 1, -kInfinity, kNan);
    if (i % 991 == 0) add_point(with, 0, 0, 0);
    if (i % 983 == 0) add_point(with, 3e38, 3e38, 3e38);
  }
  const Coded a = round_trip({.codec = CodecId::rcpcc}, cloud);
  const Coded b = round_trip({.codec = CodecId::rcpcc}, with);
  EXPECT_EQ(a.cloud.x, b.cloud.x);
  EXPECT_EQ(a.cloud.y, b.cloud.y);
  EXPECT_EQ(a.cloud.z, b.cloud.z);
  EXPECT_EQ(with.size() - cloud.size(), b.counts.not_finite + b.counts.zero_range +
                                            b.counts.out_of_view - a.counts.out_of_view);
}

TEST(Encoder, BytesDependOnTheSweepAlone) {
  const PointCloud small = street(8, 200, 2);
  const PointCloud large = street(32, 900, 3);
  for (const EncoderOptions& options : test::all_options()) {
    Encoder encoder = encoder_of(options);
    Encoder other = encoder_of(options);
    const Bytes first = encode(encoder, small);
    encode(encoder, large);
    encode(encoder, {});
    EXPECT_EQ(encode(encoder, small), first);
    encode(other, large);
    EXPECT_EQ(encode(other, small), first);

    Decoder decoder;
    PointCloud fresh;
    PointCloud reused;
    const Bytes large_frame = encode(other, large);
    ASSERT_TRUE(decoder.decode(first, fresh).has_value());
    ASSERT_TRUE(decoder.decode(large_frame, reused).has_value());
    ASSERT_TRUE(decoder.decode(first, reused).has_value());
    EXPECT_EQ(fresh.x, reused.x);
    EXPECT_EQ(fresh.y, reused.y);
    EXPECT_EQ(fresh.z, reused.z);
  }
}

TEST(Encoder, LayoutOfTheCloudDoesNotMatter) {
  const PointCloud cloud = street(16, 360);
  std::vector<std::array<float, 5>> records;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    records.push_back({cloud.x[i], 9, cloud.z[i], 9, cloud.y[i]});
  }
  const auto view =
      CloudView::records(std::as_bytes(std::span(records)), sizeof(records[0]), {0}, {16}, {8});
  EXPECT_EQ(encode({}, view), encode({}, cloud));
}

TEST(Encoder, CanBeMoved) {
  const PointCloud cloud = street(8, 200);
  Encoder encoder = encoder_of({.codec = CodecId::rcpcc});
  const Bytes frame = encode(encoder, cloud);
  Encoder moved = std::move(encoder);
  EXPECT_EQ(encode(moved, cloud), frame);
}

TEST(Encoder, RefusesOptionsOutOfRange) {
  struct Case {
    void (*change)(RcpccOptions&);
    std::string_view option, range;
  };
  const std::array cases{
      Case{[](RcpccOptions& o) { o.params.azimuth_step_deg = 0.049; }, "azimuth step",
           "0.05 and 10"},
      Case{[](RcpccOptions& o) { o.params.azimuth_step_deg = 10.1; }, "azimuth step",
           "0.05 and 10"},
      Case{[](RcpccOptions& o) { o.params.azimuth_step_deg = kNan; }, "azimuth step",
           "0.05 and 10"},
      Case{[](RcpccOptions& o) { o.params.elevation_step_deg = 0; }, "elevation step",
           "0.05 and 10"},
      Case{[](RcpccOptions& o) { o.params.elevation_step_deg = kNan; }, "elevation step", "0.05"},
      Case{[](RcpccOptions& o) { o.params.threshold_m = 0; }, "threshold", "0.001 and 10"},
      Case{[](RcpccOptions& o) { o.params.threshold_m = kNan; }, "threshold", "0.001 and 10"},
      Case{[](RcpccOptions& o) { o.params.threshold_m = kInfinity; }, "threshold", "0.001 and 10"},
      Case{[](RcpccOptions& o) { o.params.quantiser_step_m = -1; }, "quantiser step",
           "0.001 and 10"},
      Case{[](RcpccOptions& o) { o.params.quantiser_step_m = kNan; }, "quantiser step", "0.001"},
      Case{[](RcpccOptions& o) { o.elevation_min_deg = -91; }, "elevation", "-90 and 90"},
      Case{[](RcpccOptions& o) { o.elevation_min_deg = kNan; }, "elevation", "-90 and 90"},
      Case{[](RcpccOptions& o) { o.elevation_max_deg = 90.5; }, "elevation", "and 90"},
      Case{[](RcpccOptions& o) { o.elevation_max_deg = -90; }, "elevation", "and 90"},
      Case{[](RcpccOptions& o) { o.elevation_max_deg = kNan; }, "elevation", "and 90"},
      Case{[](RcpccOptions& o) { o.azimuth_min_deg = 181; }, "azimuth", "-180 and 180"},
      Case{[](RcpccOptions& o) { o.azimuth_max_deg = -kInfinity; }, "azimuth", "-180 and 180"},
      Case{[](RcpccOptions& o) { o.azimuth_max_deg = kNan; }, "azimuth", "-180 and 180"},
      Case{[](RcpccOptions& o) { o.max_range_m = 0; }, "range", "0.1 and 1000"},
      Case{[](RcpccOptions& o) { o.max_range_m = kNan; }, "range", "0.1 and 1000"},
      Case{[](RcpccOptions& o) { o.block_size = 5; }, "block size", "4, 8, 16"},
      Case{[](RcpccOptions& o) { o.block_size = 32; }, "block size", "4, 8, 16"},
      Case{[](RcpccOptions& o) { o.region_size = 0; }, "region size", "4, 8, 16, 32"},
      Case{[](RcpccOptions& o) { o.region_size = 64; }, "region size", "4, 8, 16, 32"},
      Case{[](RcpccOptions& o) { o.zstd_level = 0; }, "zstd level", "1 and 22"},
      Case{[](RcpccOptions& o) { o.zstd_level = 23; }, "zstd level", "1 and 22"},
  };
  for (const Case& c : cases) {
    EncoderOptions options;
    options.codec = CodecId::rcpcc;
    c.change(options.rcpcc);
    const auto encoder = Encoder::create(options);
    ASSERT_FALSE(encoder.has_value()) << c.option;
    EXPECT_EQ(encoder.error().code, ErrorCode::invalid_argument);
    EXPECT_NE(encoder.error().message.find(c.option), std::string::npos) << encoder.error().message;
    EXPECT_NE(encoder.error().message.find(c.range), std::string::npos) << encoder.error().message;
  }
  EncoderOptions options;
  options.codec = CodecId::rcpcc;
  options.codec = static_cast<CodecId>(77);
  EXPECT_EQ(Encoder::create(options).error().code, ErrorCode::unsupported);
}

TEST(Encoder, RefusesCropsOutOfOrder) {
  const auto nan = std::numeric_limits<float>::quiet_NaN();
  for (const Crop& crop : {Crop{-1.0F, 0.0F, {}, {}}, Crop{nan, 0.0F, {}, {}},
                           Crop{5.0F, 4.0F, {}, {}}, Crop{0.0F, 0.0F, Box{0, 0, 1, 1, 1, 0}, {}},
                           Crop{0.0F, 0.0F, {}, Box{nan, 0, 0, 1, 1, 1}}}) {
    EncoderOptions options;
    options.codec = CodecId::rcpcc;
    options.crop = crop;
    const auto encoder = Encoder::create(options);
    ASSERT_FALSE(encoder.has_value());
    EXPECT_EQ(encoder.error().code, ErrorCode::invalid_argument);
  }
}

TEST(Encoder, RefusesCloudsAndNamesThatItCannotCode) {
  Encoder encoder = encoder_of({.codec = CodecId::rcpcc});
  PointCloud cloud = street(4, 90);
  CloudView without_z = cloud;
  without_z.z = {};
  const auto lacking = encoder.encode(without_z, {});
  ASSERT_FALSE(lacking.has_value());
  EXPECT_EQ(lacking.error().code, ErrorCode::invalid_argument);
  const std::string long_name(256, 'n');
  EXPECT_EQ(encoder.encode(cloud, {0, 0, long_name}).error().code, ErrorCode::invalid_argument);
  EXPECT_TRUE(encoder.encode(cloud, {0, 0, std::string_view(long_name).substr(1)}).has_value());
  // A view of one point again and again: strides may be 0.
  CloudView many = cloud;
  many.size = (std::size_t{1} << 24) + 1;
  many.x.stride = many.y.stride = many.z.stride = 0;
  EXPECT_EQ(encoder.encode(many, {}).error().code, ErrorCode::limit);
}

TEST(Encoder, RefusesAnImageThatWouldBeTooLarge) {
  EncoderOptions options;
  options.codec = CodecId::rcpcc;
  options.rcpcc.params.azimuth_step_deg = options.rcpcc.params.elevation_step_deg = 0.05;
  Encoder encoder = encoder_of(options);
  PointCloud cloud;
  add_point(cloud, 0.01, 0, 5);
  add_point(cloud, 0.01, 0, -5);
  const auto frame = encoder.encode(cloud, {});
  ASSERT_FALSE(frame.has_value());
  EXPECT_EQ(frame.error().code, ErrorCode::limit);
  EXPECT_TRUE(encoder.encode(street(4, 90), {}).has_value());  // and goes on after errors
}

}  // namespace
}  // namespace sweepcast
