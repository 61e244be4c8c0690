// Made-up sweeps that are the same to the last bit on every machine: random bits of the 32-bit
// Mersenne twister, + - * / and square root, and the sines of core/trig.hpp.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "core/trig.hpp"
#include "sweepcast/cloud.hpp"

namespace sweepcast::test {

/// What a made-up sweep looks like.
struct MadeSweep {
  int beams = 16;
  int firings = 240;
  std::uint32_t seed = 1;
  double shift_m = 0.0;      ///< of the hall along x
  double jitter_deg = 0.0;   ///< of each point's azimuth, as an interpolating driver makes it
  int second_returns = 0;    ///< one point in so many has another behind it, at the same angles
  bool deskewed = false;     ///< moved by a constant twist, as by a driving robot
  bool by_rings = false;     ///< points come ring by ring instead of firing by firing
  bool organised = false;    ///< by rings, with NaN where there is no return
  bool attributes = false;   ///< intensity, ring and time
  bool millimetres = false;  ///< coordinates are whole ones
};

/// A number in [0, 1), a multiple of 2^-32.
inline double unit(std::mt19937& random) {
  return static_cast<double>(random()) / 4294967296.0;
}

/// A point deskewed, `turns` of the sensor from the sweep's middle.
inline std::array<double, 3> moved(const std::array<double, 3>& p, double turns) {
  // 0.8 m ahead and 2 degrees to the left in a turn of the sensor.
  const SinCos turn = sin_cos(2.0 * kDegree * turns);
  const double x = p[0] - 0.8 * turns;
  return {turn.cos * x + turn.sin * p[1], -turn.sin * x + turn.cos * p[1], p[2]};
}

/// A spinning sensor 3 cm above and beside its axis, its beams from 10 to -20 degrees, 1.8 m above
/// the floor of a hall with pillars. One return in twelve is missing; ranges are noisy by 1 cm.
inline PointCloud made_sweep(const MadeSweep& make) {
  std::mt19937 random(make.seed);
  PointCloud cloud;
  const auto add = [&](int beam, int firing, const std::array<double, 3>& p, double bright) {
    const auto stored = [&](double v) {
      return static_cast<float>(make.millimetres ? std::floor(v * 1000.0 + 0.5) / 1000.0 : v);
    };
    cloud.x.push_back(stored(p[0]));
    cloud.y.push_back(stored(p[1]));
    cloud.z.push_back(stored(p[2]));
    if (!make.attributes) return;
    cloud.intensity.push_back(static_cast<float>(static_cast<int>(bright * 200.0)));
    cloud.ring.push_back(static_cast<std::uint16_t>(beam));
    cloud.time_ns.push_back(std::int64_t{100'000'000} * firing / make.firings +
                            std::int64_t{2'304} * beam);
  };
  const auto measure = [&](int beam, int firing) {
    const double turns = static_cast<double>(firing) / make.firings - 0.5;
    const SinCos up = sin_cos((10.0 - 30.0 * beam / (make.beams - 1)) * kDegree);
    const double tangent = up.sin / up.cos;
    const double offset_deg = make.deskewed ? 0.0 : beam % 4;
    const double azimuth = 2.0 * kPi * turns + offset_deg * kDegree;
    const SinCos around = sin_cos(azimuth);
    const auto size = [](double v) { return v < 0 ? -v : v; };
    const double wall_x =
        (around.cos > 0 ? 14.0 + make.shift_m : 14.0 - make.shift_m) / (size(around.cos) + 1e-3);
    const double wall_y = 9.0 / (size(around.sin) + 1e-3);
    double rho = wall_x < wall_y ? wall_x : wall_y;
    if (firing * 36 / make.firings % 6 == 2 && rho > 4.5) rho = 4.5;
    if (tangent < -0.01 && rho > -1.8 / tangent) rho = -1.8 / tangent;
    rho += 0.02 * unit(random) - 0.01;
    const double scatter = make.jitter_deg * (2.0 * unit(random) - 1.0);
    if (unit(random) < 1.0 / 12.0) {
      if (make.organised) add(beam, firing, {NAN, NAN, NAN}, 0.0);
      return;
    }
    const bool twice =
        make.second_returns > 0 && random() % static_cast<unsigned>(make.second_returns) == 0;
    for (int echo = 0; echo < (twice ? 2 : 1); ++echo) {
      const double far = rho * (1.0 + 0.3 * echo);
      const double side = 0.02 / far;  // its arc sine, nearly
      const SinCos turned = sin_cos(azimuth + side + side * side * side / 6.0 + scatter * kDegree);
      std::array<double, 3> p{far * turned.cos, far * turned.sin, far * tangent + 0.03};
      if (make.deskewed) p = moved(p, turns);
      add(beam, firing, p, (0.3 + 0.7 * unit(random)) * (1.0 - far / 100.0));
    }
  };
  if (make.by_rings || make.organised) {
    for (int beam = 0; beam < make.beams; ++beam) {
      for (int firing = 0; firing < make.firings; ++firing) measure(beam, firing);
    }
  } else {
    for (int firing = 0; firing < make.firings; ++firing) {
      for (int beam = 0; beam < make.beams; ++beam) measure(beam, firing);
    }
  }
  if (make.organised) cloud.width = static_cast<std::uint32_t>(make.firings);
  return cloud;
}

/// Points anywhere in a box: no sensor's model fits them.
inline PointCloud made_scatter(int points, std::uint32_t seed) {
  std::mt19937 random(seed);
  PointCloud cloud;
  for (int i = 0; i < points; ++i) {
    cloud.x.push_back(static_cast<float>(40.0 * unit(random) - 20.0));
    cloud.y.push_back(static_cast<float>(40.0 * unit(random) - 20.0));
    cloud.z.push_back(static_cast<float>(6.0 * unit(random) - 2.0));
  }
  return cloud;
}

}  // namespace sweepcast::test
