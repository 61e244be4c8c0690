// Lossless: coordinates come back to the bit.
#include "codec/beam/exact_coder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <functional>
#include <limits>

#include "codec/beam/sensor.hpp"
#include "lab/real_sweeps.hpp"
#include "sweepcast/cloud_file.hpp"

namespace sweepcast::beam {
namespace {

using Bits = std::array<std::uint32_t, 4>;

/// The codable points to the bit, sorted.
std::vector<Bits> bits_of(const PointCloud& cloud) {
  std::vector<Bits> all;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double range = std::hypot(cloud.x[i], cloud.y[i], cloud.z[i]);
    if (!std::isfinite(range) || range == 0) continue;
    const float intensity = cloud.has_intensity() ? cloud.intensity[i] : 0.0F;
    all.push_back(
        {std::bit_cast<std::uint32_t>(cloud.x[i]), std::bit_cast<std::uint32_t>(cloud.y[i]),
         std::bit_cast<std::uint32_t>(cloud.z[i]), std::bit_cast<std::uint32_t>(intensity)});
  }
  std::sort(all.begin(), all.end());
  return all;
}

EncoderOptions lossless(bool keep_order = false) {
  EncoderOptions options = test::beam_options(0.05);
  options.beam.lossless = true;
  options.beam.keep_order = keep_order;
  options.beam.intensity_step = 10;  // counts for nothing
  return options;
}

/// Applies a rounding to every coordinate.
PointCloud rounded(PointCloud cloud, const std::function<float(float)>& round) {
  for (auto* column : {&cloud.x, &cloud.y, &cloud.z}) {
    std::transform(column->begin(), column->end(), column->begin(), round);
  }
  return cloud;
}

TEST(Lossless, GridsOfEveryKindAndNone) {
  const PointCloud sweep = test::spinning_sweep(16, 450, 1);
  const std::vector<std::function<float(float)>> roundings{
      [](float v) { return v; },
      [](float v) { return static_cast<float>(std::round(v * 1000.0) / 1000.0); },
      [](float v) { return std::round(v * 1000.0F) * 0.001F; },
      [](float v) { return static_cast<float>(std::round(v * 500.0) / 500.0); },
      [](float v) { return std::ldexp(std::round(std::ldexp(v, 10)), -10); },
      [](float v) { return std::round(v * 10.0F) / 10.0F; }};
  std::size_t of_floats = 0;
  for (std::size_t i = 0; i < roundings.size(); ++i) {
    SCOPED_TRACE(i);
    PointCloud cloud = rounded(sweep, roundings[i]);
    for (std::size_t k = 0; k < cloud.size(); ++k) {
      cloud.intensity.push_back(static_cast<float>(k % 97));
    }
    const test::Bytes frame = test::encode(lossless(), cloud);
    EXPECT_EQ(bits_of(test::decode(frame)), bits_of(cloud));
    if (i == 0) of_floats = frame.size();
    if (i > 0) {
      EXPECT_LT(frame.size() * 10, of_floats * 9);
    }
  }
}

TEST(Lossless, StraysDuplicatesZerosAndSignedZeros) {
  std::mt19937 random(2);
  const auto millimetres = [](float v) { return std::round(v * 1000.0F) / 1000.0F; };
  PointCloud cloud = rounded(test::spinning_sweep(16, 450, 2), millimetres);
  for (std::size_t i = 0; i < 200; ++i) test::add_point(cloud, cloud.x[i], cloud.y[i], cloud.z[i]);
  test::add_point(cloud, 5, -0.0, 0.0);
  test::add_point(cloud, 0.0, -0.0, 2);
  test::add_point(cloud, 0, 0, 0);
  test::add_point(cloud, std::numeric_limits<float>::quiet_NaN(), 0, 0);
  for (int i = 0; i < 200; ++i) {
    test::add_point(cloud, millimetres(static_cast<float>(test::uniform(random, -50, 50))),
                    millimetres(static_cast<float>(test::uniform(random, -50, 50))), 0.5);
  }
  const PointCloud decoded = test::decode(test::encode(lossless(), cloud));
  EXPECT_EQ(bits_of(decoded), bits_of(cloud));

  const PointCloud ordered = test::decode(test::encode(lossless(true), cloud));
  std::size_t at = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double range = std::hypot(cloud.x[i], cloud.y[i], cloud.z[i]);
    if (!std::isfinite(range) || range == 0) continue;
    ASSERT_LT(at, ordered.size());
    EXPECT_EQ(ordered.x[at], cloud.x[i]);
    EXPECT_EQ(ordered.y[at], cloud.y[i]);
    EXPECT_EQ(ordered.z[at], cloud.z[i]);
    ++at;
  }
  EXPECT_EQ(at, ordered.size());
}

TEST(Lossless, CloudsOfNoSensor) {
  std::mt19937 random(3);
  for (const int count : {0, 1, 3, 3000}) {
    PointCloud cloud;
    for (int i = 0; i < count; ++i) {
      test::add_point(cloud, test::uniform(random, -9, 9), test::uniform(random, -9, 9),
                      test::uniform(random, -1e3, 1e3));
    }
    EXPECT_EQ(bits_of(test::decode(test::encode(lossless(), cloud))), bits_of(cloud));
  }
}

TEST(Lossless, RangesInAUnitCostLess) {
  PointOrigins origins;
  origins.beam_m.push_back({0.0, 0.0, 0.0});
  PointCloud decoded, in_units, anywhere;
  std::vector<std::int32_t> ranges, others;
  std::mt19937 random(4);
  for (int i = 0; i < 4000; ++i) {
    const int range = 40 * test::uniform_int(random, 100, 9000);
    const double azimuth = i * 0.0015;
    const int rough = range + test::uniform_int(random, -100, 100);
    const int other = rough + test::uniform_int(random, -100, 100);
    const auto add = [&](PointCloud& cloud, int r) {
      test::add_point(cloud, r * 1e-4 * std::cos(azimuth), r * 1e-4 * std::sin(azimuth), r * 1e-5);
    };
    add(decoded, rough);
    add(in_units, range);
    add(anywhere, other);
    ranges.push_back(range);
    others.push_back(other);
    origins.row.push_back(0);
    origins.range.push_back(rough);
  }
  std::vector<std::byte> few, many;
  write_exact(decoded, origins, in_units, ranges, few);
  write_exact(decoded, origins, anywhere, others, many);
  EXPECT_LT(few.size() * 3, many.size() * 2);
  PointCloud restored = decoded;
  ASSERT_TRUE(read_exact(few, origins, restored));
  EXPECT_EQ(bits_of(restored), bits_of(in_units));
  restored = decoded;
  ASSERT_TRUE(read_exact(many, origins, restored));
  EXPECT_EQ(bits_of(restored), bits_of(anywhere));

  // Any bytes give some cloud, or an error.
  for (std::size_t i = 0; i < few.size(); i += 7) {
    std::vector<std::byte> damaged = few;
    damaged[i] ^= std::byte{0x55};
    restored = decoded;
    if (read_exact(damaged, origins, restored)) {
      EXPECT_EQ(restored.size(), decoded.size());
    }
  }
  few.resize(few.size() / 2);
  EXPECT_FALSE(read_exact(few, origins, restored));
}

TEST(Lossless, RealSweeps) {
  auto paths = lab::first_sweeps({"kitti_hdl64", "kitti_0048", "kitti_odom00"});
  for (const auto& path : lab::nebula_sweeps({"vlp16.pcd", "hesai_xt32.pcd", "hesai_ot128.pcd"})) {
    paths.push_back(path);
  }
  if (paths.empty()) GTEST_SKIP() << "set SWEEPCAST_DATA to a folder with real sweeps";
  for (const auto& path : paths) {
    SCOPED_TRACE(path.string());
    PointCloud cloud;
    ASSERT_TRUE(read_cloud(path, cloud).has_value());
    EXPECT_EQ(bits_of(test::decode(test::encode(lossless(), cloud))), bits_of(cloud));
  }
}

}  // namespace
}  // namespace sweepcast::beam
