// Synthetic sweeps, options and shorthands for the tests of the whole codec.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "core/points.hpp"
#include "core/random.hpp"
#include "sweepcast/decoder.hpp"
#include "sweepcast/encoder.hpp"

namespace sweepcast::test {

using Bytes = std::vector<std::byte>;

/// A spinning sensor 1.7 m above a street between walls, with pillars, 2 cm of noise and gaps.
inline PointCloud street(int beams, int columns, std::uint32_t seed = 1) {
  std::mt19937 random(seed);
  PointCloud cloud;
  for (int beam = 0; beam < beams; ++beam) {
    const double elevation = (2.0 - 26.0 * beam / beams) * std::numbers::pi / 180;
    for (int column = 0; column < columns; ++column) {
      const double azimuth = (column + 0.3) * 2 * std::numbers::pi / columns;
      const double to_wall = 7.0 / std::max(std::abs(std::sin(azimuth)), 0.07);
      const double to_pillar = column * 24 / columns % 4 == 1 ? 5.0 : 1e9;
      const double to_floor = elevation < 0 ? 1.7 / std::tan(-elevation) : 1e9;
      const double flat = std::min({to_wall, to_pillar, to_floor}) + uniform(random, -0.02, 0.02);
      if (random_bits(random) % 16 == 0) continue;
      add_point(cloud, flat * std::cos(azimuth), flat * std::sin(azimuth),
                flat * std::tan(elevation));
    }
  }
  return cloud;
}

/// Every choice that an encoder's options have, at least once.
inline std::vector<EncoderOptions> all_options() {
  std::vector<EncoderOptions> all;
  const auto add = [&](auto change) {
    EncoderOptions options;
    options.codec = CodecId::rcpcc;
    change(options.rcpcc);
    all.push_back(options);
  };
  for (const RcpccParams& params : kRcpccLevels) add([&](RcpccOptions& o) { o.params = params; });
  add([](RcpccOptions&) {});
  for (const int size : {4, 8, 16}) add([&](RcpccOptions& o) { o.block_size = size; });
  for (const int size : {4, 8, 16, 32}) add([&](RcpccOptions& o) { o.region_size = size; });
  add([](RcpccOptions& o) { o.model = SurfaceModel::plane; });
  add([](RcpccOptions& o) { o.unfit = UnfitCoding::raw; });
  add([](RcpccOptions& o) { o.rounding = Rounding::truncate; });
  add([](RcpccOptions& o) { o.collision = CollisionRule::nearest_range; });
  for (const int level : {1, 9, 22}) add([&](RcpccOptions& o) { o.zstd_level = level; });
  add([](RcpccOptions& o) { o.params = {0.05, 0.05, 0.001, 0.001}; });
  add([](RcpccOptions& o) { o.params = {10, 10, 10, 10}; });
  add([](RcpccOptions& o) {
    o.azimuth_min_deg = 120;  // across the seam
    o.azimuth_max_deg = -60;
    o.elevation_min_deg = -20;
    o.elevation_max_deg = 1;
    o.max_range_m = 30;
  });
  return all;
}

inline Encoder encoder_of(const EncoderOptions& options) {
  auto encoder = Encoder::create(options);
  EXPECT_TRUE(encoder.has_value());
  return std::move(*encoder);
}

inline Bytes encode(Encoder& encoder, const CloudView& cloud, const SweepInfo& info = {}) {
  const auto frame = encoder.encode(cloud, info);
  EXPECT_TRUE(frame.has_value());
  if (!frame) return {};
  return {frame->begin(), frame->end()};
}

inline Bytes encode(const EncoderOptions& options, const CloudView& cloud,
                    const SweepInfo& info = {}) {
  Encoder encoder = encoder_of(options);
  return encode(encoder, cloud, info);
}

inline PointCloud decode(const Bytes& frame) {
  PointCloud cloud;
  Decoder decoder;
  const Status status = decoder.decode(frame, cloud);
  EXPECT_TRUE(status.has_value()) << status.error().message;
  return cloud;
}

}  // namespace sweepcast::test
