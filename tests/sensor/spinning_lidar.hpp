// A made-up spinning LiDAR whose points are computed with the C library's functions, apart from
// the code under test.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "core/random.hpp"
#include "sweepcast/sensor_model.hpp"

namespace sweepcast::test {

inline constexpr double kRadian = 57.295779513082320877;  // degrees

/// 16 beams from 6 to -18 degrees in two blocks of unlike heights, 2000 ticks, lateral offsets left
/// and right by turns, lags.
inline SensorModel made_up_model() {
  constexpr std::array kLags{0, 17, -9, 31, 4, -22};
  SensorModel model;
  model.ticks_per_turn = 2000;
  for (int k = 0; k < 16; ++k) {
    Beam beam;
    const double elevation = 6.0 - 1.5 * k + 0.21 * (k % 3);
    beam.tan_elevation =
        static_cast<std::int32_t>(std::lround(std::tan(elevation / kRadian) * kTangentUnits));
    beam.height = k < 8 ? 19'000 : 11'000;
    beam.azimuth_offset = (k * 7919 % 150'000) - 75'000;
    beam.lateral_offset = k % 2 == 0 ? 2'500 : -2'500;
    beam.lag = kLags[static_cast<std::size_t>(k) % kLags.size()];
    model.beams.push_back(beam);
  }
  return model;
}

/// Ticks of the firings of `made_up_model`: at steps of 2 and 1 that never repeat.
inline std::vector<int> firings(const SensorModel& model) {
  constexpr double kStep = 1.7320508;
  std::vector<int> ticks;
  for (int j = 0; j * kStep < model.ticks_per_turn - 1; ++j) {
    ticks.push_back(static_cast<int>(j * kStep));
  }
  return ticks;
}

/// The point that beam k measures at firing tick and horizontal distance.
inline std::array<double, 3> point_of(const SensorModel& model, std::size_t k, int firing,
                                      double rho) {
  const Beam& beam = model.beams[k];
  const double azimuth = (firing + beam.lag) * 360.0 / model.ticks_per_turn +
                         beam.azimuth_offset / 1e6 +
                         std::asin(beam.lateral_offset / 1e5 / rho) * kRadian;
  return {rho * std::cos(azimuth / kRadian), rho * std::sin(azimuth / kRadian),
          rho * beam.tan_elevation / 16777216.0 + beam.height / 1e5};
}

inline void push(PointCloud& cloud, const std::array<double, 3>& p) {
  cloud.x.push_back(static_cast<float>(p[0]));
  cloud.y.push_back(static_cast<float>(p[1]));
  cloud.z.push_back(static_cast<float>(p[2]));
}

/// A street: walls to both sides, uneven ground, and a share of beams that return nothing. Points
/// come in a random order.
inline PointCloud sweep_of(const SensorModel& model, std::mt19937& random, double rounding = 0.0) {
  std::vector<std::array<double, 3>> points;
  for (std::size_t k = 0; k < model.beams.size(); ++k) {
    const double tangent = model.beams[k].tan_elevation / 16777216.0;
    for (const int tick : firings(model)) {
      if (uniform(random, 0.0, 1.0) < 0.1) continue;
      const double azimuth = tick * 360.0 / model.ticks_per_turn / kRadian;
      const double side = 7.0 / std::max(std::abs(std::sin(azimuth)), 0.08);
      const double slope = 1.0 + 0.3 * std::sin(3.0 * azimuth);
      const double ground = tangent < -0.02 ? 1.9 * slope / -tangent : 1e9;
      const double rho = std::min(side, ground) + uniform(random, -0.02, 0.02);
      std::array<double, 3> p = point_of(model, k, tick, rho);
      for (double& v : p) v = rounding > 0.0 ? std::round(v / rounding) * rounding : v;
      points.push_back(p);
    }
  }
  for (std::size_t i = points.size(); i > 1; --i) {
    std::swap(points[i - 1],
              points[static_cast<std::size_t>(uniform_int(random, 0, static_cast<int>(i) - 1))]);
  }
  PointCloud cloud;
  for (const auto& p : points) push(cloud, p);
  return cloud;
}

inline double distance(const PointCloud& a, std::size_t i, const PointCloud& b, std::size_t j) {
  return std::hypot(static_cast<double>(a.x[i]) - b.x[j], static_cast<double>(a.y[i]) - b.y[j],
                    static_cast<double>(a.z[i]) - b.z[j]);
}

}  // namespace sweepcast::test
