// The order of a cloud's points.
#include "codec/beam/point_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "codec/beam/sensor.hpp"

namespace sweepcast::beam {
namespace {

TEST(PointOrder, FiringByFiringThenRowByRow) {
  BeamImage image;
  image.rows = 3;
  image.cols = 4;
  image.range = {5, 0, 5, 5,  //
                 5, 5, 0, 5,  //
                 0, 5, 5, 0};
  std::vector<std::uint32_t> slots{99};
  std::vector<std::uint32_t> next;
  firing_order(image, next, slots);
  EXPECT_EQ(slots, (std::vector<std::uint32_t>{99, 0, 4, 6, 1, 2, 7, 3, 5}));
}

TEST(PointOrder, NoImageNoPoints) {
  std::vector<std::uint32_t> slots;
  std::vector<std::uint32_t> next;
  firing_order({}, next, slots);
  EXPECT_TRUE(slots.empty());
}

/// An image whose cells have a point as `chance` says, in percent, row after row.
BeamImage image_of(int rows, int cols, int chance, std::mt19937& random) {
  BeamImage image;
  image.rows = rows;
  image.cols = cols;
  for (std::size_t i = 0; i < image.cells(); ++i) {
    image.range.push_back(test::uniform_int(random, 0, 99) < chance ? 10'000 : 0);
  }
  return image;
}

/// Writes an order and reads it again; gives the bytes' number.
std::size_t expect_round_trip(const PointOrder& order, const BeamImage& image, std::size_t extras) {
  std::vector<std::byte> bytes;
  write_order(order, image, extras, bytes);
  PointOrder decoded;
  EXPECT_TRUE(read_order(bytes, image, extras, order.items.size(), decoded));
  EXPECT_EQ(decoded.items, order.items);
  EXPECT_EQ(decoded.width, order.width);
  if (!order.items.empty()) {
    EXPECT_FALSE(read_order(bytes, image, extras, order.items.size() - 1, decoded));
    EXPECT_FALSE(read_order(bytes, image, extras + 1, order.items.size(), decoded));
  }
  return bytes.size();
}

/// Items of all points, row by row, then the extras.
PointOrder ring_by_ring(const BeamImage& image, std::size_t extras) {
  PointOrder order;
  for (std::uint32_t cell = 0; cell < image.cells(); ++cell) {
    if (image.range[cell] != 0) order.items.push_back(cell);
  }
  for (std::size_t i = 0; i < extras; ++i) {
    order.items.push_back(static_cast<std::uint32_t>(image.cells() + i));
  }
  return order;
}

TEST(PointOrder, RegularOrdersCostLittle) {
  std::mt19937 random(1);
  const BeamImage image = image_of(32, 500, 85, random);
  PointOrder order = ring_by_ring(image, 3);
  EXPECT_LT(expect_round_trip(order, image, 3), 250U);
  std::reverse(order.items.begin(), order.items.end());
  EXPECT_LT(expect_round_trip(order, image, 3), 250U);

  // Firing by firing, beams in an order of their own, some of them firings ahead.
  order.items.clear();
  for (int firing = 0; firing < 500; ++firing) {
    for (int beam = 0; beam < 32; ++beam) {
      const int row = beam * 11 % 32;
      const int col = (firing + row * 37) % 500;
      const auto cell = static_cast<std::uint32_t>(row * 500 + col);
      if (image.range[cell] != 0) order.items.push_back(cell);
    }
  }
  EXPECT_LT(expect_round_trip(order, image, 0), 250U);
}

TEST(PointOrder, AnyOrderIsRestored) {
  std::mt19937 random(2);
  for (const int extras : {0, 1, 40}) {
    for (const int rows : {1, 2, 32}) {
      for (const int chance : {0, 30, 100}) {
        const BeamImage image = image_of(rows, 200, chance, random);
        PointOrder order = ring_by_ring(image, static_cast<std::size_t>(extras));
        std::shuffle(order.items.begin(), order.items.end(), random);
        const auto count = static_cast<double>(order.items.size());
        EXPECT_LT(
            static_cast<double>(expect_round_trip(order, image, static_cast<std::size_t>(extras))),
            4.0 * rows + 100 + count * (std::log2(count + 1) + 4) / 8);
      }
    }
  }
}

TEST(PointOrder, OrganisedCloudsKeepTheirSlots) {
  std::mt19937 random(3);
  const BeamImage image = image_of(16, 300, 70, random);
  PointOrder order;
  order.width = 300;
  for (std::uint32_t cell = 0; cell < image.cells(); ++cell) {
    order.items.push_back(image.range[cell] != 0 ? cell : PointOrder::kDropped);
  }
  EXPECT_LT(expect_round_trip(order, image, 0), 200U);
  std::shuffle(order.items.begin(), order.items.end(), random);
  expect_round_trip(order, image, 0);
}

TEST(PointOrder, BytesOfNoOrderAreRefused) {
  std::mt19937 random(4);
  const BeamImage image = image_of(8, 100, 60, random);
  PointOrder order = ring_by_ring(image, 5);
  std::vector<std::byte> bytes;
  write_order(order, image, 5, bytes);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::byte> damaged = bytes;
    const auto at = test::random_bits(random) % damaged.size();
    damaged[at] ^= static_cast<std::byte>(1U << (test::random_bits(random) % 8));
    damaged.resize(test::random_bits(random) % 2 == 0 ? damaged.size() : at);
    PointOrder decoded;
    if (!read_order(damaged, image, 5, 10'000, decoded)) {
      ++refused;
      continue;
    }
    // What passes is an order: every point once.
    auto& items = decoded.items;
    items.erase(std::remove(items.begin(), items.end(), PointOrder::kDropped), items.end());
    std::sort(items.begin(), items.end());
    EXPECT_EQ(items, order.items);
  }
  EXPECT_GT(refused, 100);
}

/// A cloud with attributes that tell its points apart, its points shuffled.
PointCloud shuffled_sweep(std::uint32_t seed) {
  const PointCloud sweep = test::spinning_sweep(16, 450, seed);
  std::mt19937 random(seed);
  std::vector<std::size_t> permutation(sweep.size());
  std::iota(permutation.begin(), permutation.end(), std::size_t{0});
  std::shuffle(permutation.begin(), permutation.end(), random);
  PointCloud cloud;
  for (const std::size_t i : permutation) {
    test::add_point(cloud, sweep.x[i], sweep.y[i], sweep.z[i]);
    cloud.intensity.push_back(static_cast<float>(cloud.size() % 251));
  }
  return cloud;
}

void expect_same_place(const PointCloud& cloud, const PointCloud& decoded, double max_error) {
  ASSERT_EQ(decoded.size(), cloud.size());
  EXPECT_EQ(decoded.width, cloud.width);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double range = std::hypot(cloud.x[i], cloud.y[i], cloud.z[i]);
    if (!std::isfinite(range) || range == 0) {
      EXPECT_TRUE(std::isnan(decoded.x[i]) && std::isnan(decoded.y[i]) && std::isnan(decoded.z[i]));
      continue;
    }
    EXPECT_LE(std::hypot(double{cloud.x[i]} - double{decoded.x[i]},
                         double{cloud.y[i]} - double{decoded.y[i]},
                         double{cloud.z[i]} - double{decoded.z[i]}),
              max_error + 1e-5);
    if (cloud.has_intensity()) {
      EXPECT_EQ(decoded.intensity[i], cloud.intensity[i]);
    }
  }
}

EncoderOptions ordered(double max_error) {
  EncoderOptions options = test::beam_options(max_error);
  options.beam.keep_order = true;
  return options;
}

TEST(KeepOrder, AShuffledSweepComesBackAsItWas) {
  PointCloud cloud = shuffled_sweep(5);
  expect_same_place(cloud, test::decode(test::encode(ordered(0.02), cloud)), 0.02);
  for (std::size_t i = 0; i < 300; ++i) {  // duplicates
    test::add_point(cloud, cloud.x[i], cloud.y[i], cloud.z[i]);
    cloud.intensity.push_back(static_cast<float>(i % 100));
  }
  expect_same_place(cloud, test::decode(test::encode(ordered(0.02), cloud)), 0.02);
}

TEST(KeepOrder, ACloudOfNoSensorToo) {
  std::mt19937 random(6);
  for (const int count : {0, 1, 2, 2000}) {
    PointCloud cloud;
    for (int i = 0; i < count; ++i) {
      test::add_point(cloud, test::uniform(random, -9, 9), test::uniform(random, -9, 9),
                      test::uniform(random, -9, 9));
    }
    expect_same_place(cloud, test::decode(test::encode(ordered(0.02), cloud)), 0.02);
  }
}

TEST(KeepOrder, OrganisedCloudsComeBackOrganised) {
  PointCloud cloud = shuffled_sweep(7);
  cloud.resize_xyz(cloud.size() / 16 * 16);
  cloud.intensity.resize(cloud.size());
  cloud.width = 16;
  for (std::size_t i = 0; i < cloud.size(); i += 7) {
    cloud.x[i] = i % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : 0.0F;
    cloud.y[i] = cloud.z[i] = cloud.x[i];
  }
  expect_same_place(cloud, test::decode(test::encode(ordered(0.02), cloud)), 0.02);

  DecoderOptions options;
  options.max_points = cloud.size() - 1;
  PointCloud decoded;
  EXPECT_FALSE(Decoder(options).decode(test::encode(ordered(0.02), cloud), decoded).has_value());
}

TEST(KeepOrder, WithoutAllLayersPointsComeFiringByFiring) {
  const PointCloud cloud = shuffled_sweep(8);
  const test::Bytes with = test::encode(ordered(0.02), cloud);
  const test::Bytes without = test::encode(test::beam_options(0.02), cloud);
  DecoderOptions options;
  options.max_layers = 3;
  PointCloud a, b;
  ASSERT_TRUE(Decoder(options).decode(with, a).has_value());
  ASSERT_TRUE(Decoder(options).decode(without, b).has_value());
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.intensity, b.intensity);
  // A frame whose order is cut off.
  const test::Bytes cut(with.begin(), with.end() - 1);
  ASSERT_TRUE(Decoder().decode(cut, a).has_value());
  ASSERT_TRUE(Decoder().decode(without, b).has_value());
  EXPECT_EQ(a.x, b.x);
}

}  // namespace
}  // namespace sweepcast::beam
