// A simulated clean spinning sensor, and the exact check of an error bound.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

#include "codec/scene.hpp"

namespace sweepcast::test {

/// A sensor of `beams` beams from 10 to -20 degrees, 3 cm above and 2 cm beside its axis, in a hall
/// whose walls stand at `shift` metres from the middle; ground 1.8 m below. A share of the beams
/// has no return; ranges are noisy by 1 cm. `size`: of the hall, against its 28 m by 18 m.
inline PointCloud spinning_sweep(int beams, int firings, std::uint32_t seed, double shift = 0.0,
                                 double size = 1.0) {
  std::mt19937 random(seed);
  PointCloud cloud;
  for (int firing = 0; firing < firings; ++firing) {
    for (int beam = 0; beam < beams; ++beam) {
      const double elevation = (10.0 - 30.0 * beam / std::max(beams - 1, 1)) / 57.29577951308232;
      const double azimuth = 2 * std::numbers::pi * firing / firings + (beam % 4) * 0.01;
      const double wall_x = (std::cos(azimuth) > 0 ? 14.0 + shift : 14.0 - shift) /
                            std::max(std::abs(std::cos(azimuth)), 1e-3);
      const double wall_y = 9.0 / std::max(std::abs(std::sin(azimuth)), 1e-3);
      const double pillar = firing * 36 / firings % 6 == 2 ? 4.5 : 1e9;
      const double ground = elevation < -0.01 ? 1.8 / std::tan(-elevation) : 1e9;
      const double rho =
          size * std::min({wall_x, wall_y, pillar, ground}) + uniform(random, -0.01, 0.01);
      if (random_bits(random) % 12 == 0) continue;
      const double turned = azimuth + std::asin(0.02 / rho);
      add_point(cloud, rho * std::cos(turned), rho * std::sin(turned),
                rho * std::tan(elevation) + 0.03);
    }
  }
  return cloud;
}

/// The largest distance from a point of `truth` to the nearest of `decoded`, if it is at most
/// `reach`; infinite if some point has none within reach. Exact: all points of the 27 cells around,
/// of a grid whose cells are `reach` wide, are looked at.
inline double worst_distance(const PointCloud& truth, const PointCloud& decoded, double reach) {
  const auto cell = [&](double v) { return static_cast<std::int64_t>(std::floor(v / reach)); };
  const auto key = [](std::int64_t x, std::int64_t y, std::int64_t z) {
    return (x + (1 << 20)) << 42 | (y + (1 << 20)) << 21 | (z + (1 << 20));
  };
  std::unordered_multimap<std::int64_t, std::size_t> grid;
  grid.reserve(decoded.size());
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    grid.emplace(key(cell(decoded.x[i]), cell(decoded.y[i]), cell(decoded.z[i])), i);
  }
  double worst = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (int n = 0; n < 27; ++n) {
      const auto [first, last] =
          grid.equal_range(key(cell(truth.x[i]) + n % 3 - 1, cell(truth.y[i]) + n / 3 % 3 - 1,
                               cell(truth.z[i]) + n / 9 - 1));
      for (auto it = first; it != last; ++it) {
        const std::size_t j = it->second;
        nearest = std::min(nearest, std::hypot(double{truth.x[i]} - double{decoded.x[j]},
                                               double{truth.y[i]} - double{decoded.y[j]},
                                               double{truth.z[i]} - double{decoded.z[j]}));
      }
    }
    worst = std::max(worst, nearest <= reach ? nearest : std::numeric_limits<double>::infinity());
  }
  return worst;
}

inline EncoderOptions beam_options(double max_error_m, int model_interval = 10) {
  EncoderOptions options;
  options.codec = CodecId::beam;
  options.beam.max_error_m = max_error_m;
  options.beam.model_interval = model_interval;
  return options;
}

/// The finite points with a range.
inline PointCloud codable(const PointCloud& cloud) {
  PointCloud kept;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double range = std::hypot(cloud.x[i], cloud.y[i], cloud.z[i]);
    if (std::isfinite(range) && range > 0) add_point(kept, cloud.x[i], cloud.y[i], cloud.z[i]);
  }
  return kept;
}

/// Every codable point has a decoded one within the bound, there are as many, and the counts say
/// where each went. Float coordinates of up to 1 km may themselves be off by 0.1 mm.
inline void expect_kept(const PointCloud& cloud, const PointCloud& decoded,
                        const SweepCounts& counts, double max_error_m) {
  const PointCloud truth = codable(cloud);
  EXPECT_EQ(counts.points_in, cloud.size());
  EXPECT_EQ(sum_without_input(counts), cloud.size());
  EXPECT_EQ(counts.points_coded, decoded.size());
  EXPECT_EQ(decoded.size(), truth.size());
  const double slack = 1e-5;
  EXPECT_LE(worst_distance(truth, decoded, max_error_m + slack), max_error_m + slack);
  EXPECT_LE(worst_distance(decoded, truth, max_error_m + slack), max_error_m + slack);
}

}  // namespace sweepcast::test
