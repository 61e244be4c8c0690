// Intensity, ring and time through codec beam: exact, or within the step asked for.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <functional>
#include <limits>
#include <tuple>

#include "codec/beam/attribute_format.hpp"
#include "codec/beam/codec.hpp"
#include "codec/beam/sensor.hpp"
#include "lab/real_sweeps.hpp"
#include "rounds.hpp"
#include "sweepcast/cloud_file.hpp"

namespace sweepcast {
namespace {

using test::Bytes;
using test::random_bits;
using test::uniform;
using test::uniform_int;

/// One point's attributes, comparable; the intensity by its bits.
using Attributes = std::tuple<std::uint32_t, std::uint16_t, std::int64_t>;

std::vector<Attributes> attributes_of(const PointCloud& cloud) {
  std::vector<Attributes> all(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    all[i] = {cloud.has_intensity() ? std::bit_cast<std::uint32_t>(cloud.intensity[i]) : 0U,
              cloud.has_ring() ? cloud.ring[i] : std::uint16_t{0},
              cloud.has_time() ? cloud.time_ns[i] : 0};
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// A sweep whose time tells which point is which: every time occurs once.
PointCloud tagged_sweep(int beams, int firings, std::uint32_t seed) {
  PointCloud cloud = test::spinning_sweep(beams, firings, seed);
  std::mt19937 random(seed);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.intensity.push_back(static_cast<float>(uniform_int(random, 0, 255)));
    cloud.ring.push_back(static_cast<std::uint16_t>(uniform_int(random, 0, 127)));
    cloud.time_ns.push_back(static_cast<std::int64_t>(i) * 1152 + (random_bits(random) % 3));
  }
  cloud.time_ns.front() = 0;
  return cloud;
}

/// Each decoded point has the attributes of the original that has its time, and lies near it.
void expect_belongs(const PointCloud& cloud, const PointCloud& decoded, double max_error) {
  std::vector<std::pair<std::int64_t, std::size_t>> by_time;
  for (std::size_t i = 0; i < cloud.size(); ++i) by_time.emplace_back(cloud.time_ns[i], i);
  std::sort(by_time.begin(), by_time.end());
  ASSERT_EQ(decoded.time_ns.size(), decoded.size());
  ASSERT_EQ(decoded.intensity.size(), decoded.size());
  ASSERT_EQ(decoded.ring.size(), decoded.size());
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    const auto found = std::lower_bound(by_time.begin(), by_time.end(),
                                        std::pair{decoded.time_ns[i], std::size_t{0}});
    ASSERT_TRUE(found != by_time.end() && found->first == decoded.time_ns[i]) << i;
    const std::size_t j = found->second;
    EXPECT_EQ(decoded.intensity[i], cloud.intensity[j]);
    EXPECT_EQ(decoded.ring[i], cloud.ring[j]);
    EXPECT_LE(std::hypot(double{decoded.x[i]} - double{cloud.x[j]},
                         double{decoded.y[i]} - double{cloud.y[j]},
                         double{decoded.z[i]} - double{cloud.z[j]}),
              max_error + 1e-5);
  }
}

TEST(BeamAttributes, EveryPointKeepsItsOwn) {
  const PointCloud cloud = tagged_sweep(32, 900, 1);
  const PointCloud decoded = test::decode(test::encode(test::beam_options(0.05), cloud));
  EXPECT_EQ(decoded.size(), cloud.size());
  expect_belongs(cloud, decoded, 0.05);
}

TEST(BeamAttributes, PointsOfNoSensorKeepTheirs) {
  std::mt19937 random(2);
  for (const int count : {1, 2, 3000}) {
    PointCloud cloud;
    for (int i = 0; i < count; ++i) {
      test::add_point(cloud, uniform(random, -40, 40), uniform(random, -40, 40),
                      uniform(random, -3, 9));
      cloud.intensity.push_back(static_cast<float>(uniform_int(random, 0, 99)) / 100.0F);
      cloud.ring.push_back(static_cast<std::uint16_t>(random_bits(random)));
      cloud.time_ns.push_back(i * 1000);
    }
    const PointCloud decoded = test::decode(test::encode(test::beam_options(0.02), cloud));
    EXPECT_EQ(decoded.size(), cloud.size());
    expect_belongs(cloud, decoded, 0.02);
  }
}

TEST(BeamAttributes, CrowdedPointsKeepTheirs) {
  PointCloud cloud = tagged_sweep(32, test::rounds(900), 4);
  for (const double max_error : {0.2, 0.5, 1.0}) {
    const PointCloud decoded = test::decode(test::encode(test::beam_options(max_error), cloud));
    EXPECT_EQ(decoded.size(), cloud.size());
    expect_belongs(cloud, decoded, max_error);
  }
}

TEST(BeamAttributes, DuplicatesAndUncodablePoints) {
  PointCloud cloud = tagged_sweep(16, 600, 3);
  const std::size_t before = cloud.size();
  const auto add = [&](float x, float y, float z) {
    test::add_point(cloud, x, y, z);
    cloud.intensity.push_back(7);
    cloud.ring.push_back(3);
    cloud.time_ns.push_back(static_cast<std::int64_t>(cloud.size()) * 1152);
  };
  add(std::numeric_limits<float>::quiet_NaN(), 1, 1);
  add(0, 0, 0);
  for (std::size_t i = 0; i < before; i += 40) add(cloud.x[i], cloud.y[i], cloud.z[i]);
  const PointCloud decoded = test::decode(test::encode(test::beam_options(0.05), cloud));
  EXPECT_EQ(decoded.size(), cloud.size() - 2);
  std::mt19937 random(3);
  expect_belongs(cloud, decoded, 0.05);
}

TEST(BeamAttributes, AnyPrefixOfLayersHasItsOwn) {
  const PointCloud cloud = tagged_sweep(32, test::rounds(900), 4);
  const Bytes frame = test::encode(test::beam_options(0.05), cloud);
  std::size_t fewer = 0;
  for (int layers = 1; layers <= 5; ++layers) {
    DecoderOptions options;
    options.max_layers = layers;
    PointCloud decoded;
    ASSERT_TRUE(Decoder(options).decode(frame, decoded).has_value());
    EXPECT_GT(decoded.size(), fewer);
    fewer = decoded.size();
    expect_belongs(cloud, decoded, 0.05);
  }
  EXPECT_EQ(fewer, cloud.size());
}

TEST(BeamAttributes, FieldsThatAreNotAskedForStayAway) {
  const PointCloud cloud = tagged_sweep(16, 300, 5);
  std::size_t larger = 0;
  for (const Fields fields : {Fields::xyz, Fields::xyzi, Fields::all}) {
    EncoderOptions options = test::beam_options(0.05);
    options.beam.fields = fields;
    const Bytes frame = test::encode(options, cloud);
    const PointCloud decoded = test::decode(frame);
    EXPECT_EQ(decoded.has_intensity(), fields != Fields::xyz);
    EXPECT_EQ(decoded.has_ring(), fields == Fields::all);
    EXPECT_EQ(decoded.has_time(), fields == Fields::all);
    EXPECT_GT(frame.size(), larger);
    larger = frame.size();
  }
}

TEST(BeamAttributes, ASensorsRingAndTimeCostNextToNothing) {
  PointCloud cloud = test::spinning_sweep(32, 900, 6);
  // The sweep is firing by firing; cells without a return are left out.
  EncoderOptions options = test::beam_options(0.05);
  const std::size_t bare = test::encode(options, cloud).size();
  std::mt19937 random(6);
  double last = 1e9;
  std::int64_t firing = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double slope = std::atan2(cloud.z[i] - 0.03, std::hypot(cloud.x[i], cloud.y[i]));
    if (slope > last) ++firing;
    last = slope;
    const auto beam =
        static_cast<std::int64_t>(std::lround((10.0 - slope * 57.29577951) * 31 / 30));
    cloud.ring.push_back(static_cast<std::uint16_t>(31 - beam));
    cloud.time_ns.push_back(firing * 55'296 + beam * 2'304);
  }
  const Bytes frame = test::encode(options, cloud);
  // Firings are alike, so that the model may take a beam's for those before or after: where the
  // sweep begins and ends, times then are a turn off what beam and firing tell.
  EXPECT_LT(frame.size(), bare + 1000);
  EXPECT_EQ(attributes_of(test::decode(frame)), attributes_of(cloud));
}

TEST(BeamAttributes, IntensitiesOfEveryUnitAreExact) {
  std::mt19937 random(7);
  const std::vector<std::function<float(int)>> units{
      [](int k) { return static_cast<float>(k); },
      [](int k) { return static_cast<float>(k) * 0.01F; },
      [](int k) { return static_cast<float>(k / 255.0); },
      [](int k) { return static_cast<float>(k * 257); },
      [](int k) { return static_cast<float>(k - 100); },
      [](int k) { return static_cast<float>(std::sin(k)); },
      [&](int) { return static_cast<float>(uniform(random, -1e6, 1e6)); },
      [](int k) { return k % 7 == 0 ? -0.0F : std::ldexp(1.0F, k % 60 - 30); },
      [](int k) {
        return k % 9 == 0   ? std::numeric_limits<float>::infinity()
               : k % 7 == 0 ? std::numeric_limits<float>::quiet_NaN()
                            : static_cast<float>(k);
      }};
  PointCloud cloud = test::spinning_sweep(16, 300, 7);
  for (std::size_t unit = 0; unit < units.size(); ++unit) {
    SCOPED_TRACE(unit);
    cloud.intensity.clear();
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      cloud.intensity.push_back(units[unit](uniform_int(random, 0, 255)));
    }
    const PointCloud decoded = test::decode(test::encode(test::beam_options(0.05), cloud));
    EXPECT_EQ(attributes_of(decoded), attributes_of(cloud));
  }
}

TEST(BeamAttributes, IntensitiesStayWithinHalfTheStep) {
  std::mt19937 random(8);
  PointCloud cloud = tagged_sweep(16, 300, 8);
  for (float& intensity : cloud.intensity) intensity = static_cast<float>(uniform(random, -3, 90));
  EncoderOptions options = test::beam_options(0.05);
  std::size_t larger = std::numeric_limits<std::size_t>::max();
  for (const double step : {0.01, 0.5, 8.0}) {
    options.beam.intensity_step = step;
    const Bytes frame = test::encode(options, cloud);
    const PointCloud decoded = test::decode(frame);
    EXPECT_LT(frame.size(), larger);
    larger = frame.size();
    ASSERT_EQ(decoded.size(), cloud.size());
    std::vector<std::pair<std::int64_t, float>> a, b;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      a.emplace_back(cloud.time_ns[i], cloud.intensity[i]);
      b.emplace_back(decoded.time_ns[i], decoded.intensity[i]);
    }
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(a[i].first, b[i].first);
      EXPECT_LE(std::abs(a[i].second - b[i].second), step / 2 + 1e-5);
    }
  }
  for (const double step : {-1.0, 1e7, std::nan("")}) {
    options.beam.intensity_step = step;
    EXPECT_FALSE(Encoder::create(options).has_value());
  }
}

TEST(BeamAttributes, RealSweepsKeepTheirs) {
  auto paths = lab::first_sweeps({"kitti_hdl64", "kitti_odom00", "pandaset_pandar64"});
  for (const auto& path : lab::nebula_sweeps({"vlp16.pcd"})) paths.push_back(path);
  if (paths.empty()) GTEST_SKIP() << "set SWEEPCAST_DATA to a folder with real sweeps";
  for (const auto& path : paths) {
    SCOPED_TRACE(path.string());
    PointCloud cloud;
    ASSERT_TRUE(read_cloud(path, cloud).has_value());
    const PointCloud decoded = test::decode(test::encode(test::beam_options(0.05), cloud));
    EXPECT_EQ(decoded.has_ring(), cloud.has_ring());
    EXPECT_EQ(decoded.has_time(), cloud.has_time());
    ASSERT_EQ(decoded.size(), cloud.size());
    EXPECT_EQ(attributes_of(decoded), attributes_of(cloud));
  }
}

}  // namespace
}  // namespace sweepcast
