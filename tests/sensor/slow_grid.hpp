// The spherical grid in double, slow and plain, for the tests of the fast one.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "core/points.hpp"
#include "sweepcast/cloud.hpp"
#include "sweepcast/encoder.hpp"

namespace sweepcast::test {

inline constexpr double kDeg = 180.0 / std::numbers::pi;

inline void add_polar(PointCloud& cloud, double azimuth_deg, double elevation_deg, double range) {
  const double a = azimuth_deg / kDeg;
  const double e = elevation_deg / kDeg;
  add_point(cloud, range * std::cos(e) * std::cos(a), range * std::cos(e) * std::sin(a),
            range * std::sin(e));
}

struct Polar {
  double azimuth, elevation, range;  // degrees, degrees, metres
};

inline Polar polar_of(const PointCloud& cloud, std::size_t i) {
  const double x = cloud.x[i];
  const double y = cloud.y[i];
  const double z = cloud.z[i];
  return {std::atan2(y, x) * kDeg, std::atan2(z, std::hypot(x, y)) * kDeg, std::hypot(x, y, z)};
}

/// All points of every cell, and the counts.
struct SlowGrid {
  struct Candidate {
    double off_centre;  // steps
    double range;
  };
  std::map<std::pair<int, int>, std::vector<Candidate>> cells;  // by row (of the view) and column
  SweepCounts counts;

  SlowGrid(const PointCloud& cloud, const RcpccOptions& o, const Crop& crop) {
    for (std::size_t i = 0; i < cloud.size(); ++i) count(cloud, i, o, crop);
    for (const auto& cell : cells) {
      ++counts.points_coded;
      counts.collided += static_cast<std::uint32_t>(cell.second.size() - 1);
    }
  }

  void count(const PointCloud& cloud, std::size_t i, const RcpccOptions& o, const Crop& crop) {
    ++counts.points_in;
    if (!std::isfinite(cloud.x[i]) || !std::isfinite(cloud.y[i]) || !std::isfinite(cloud.z[i])) {
      ++counts.not_finite;
      return;
    }
    const Polar p = polar_of(cloud, i);
    if (p.range < 0.0005) {
      ++counts.zero_range;
      return;
    }
    const auto in = [&](const Box& b) {
      return b.min_x <= cloud.x[i] && cloud.x[i] <= b.max_x && b.min_y <= cloud.y[i] &&
             cloud.y[i] <= b.max_y && b.min_z <= cloud.z[i] && cloud.z[i] <= b.max_z;
    };
    if (p.range < crop.min_range || (crop.max_range > 0 && p.range > crop.max_range) ||
        (crop.keep && !in(*crop.keep)) || (crop.robot && in(*crop.robot))) {
      ++counts.cropped;
      return;
    }
    const double from_first = std::fmod(p.azimuth - o.azimuth_min_deg + 720.0, 360.0);
    double width = o.azimuth_max_deg - o.azimuth_min_deg;
    if (width <= 0) width += 360.0;
    const double u = from_first / o.params.azimuth_step_deg;
    const double v = (p.elevation - o.elevation_min_deg) / o.params.elevation_step_deg;
    const double cols = std::ceil(width / o.params.azimuth_step_deg - 1e-9);
    const double rows =
        std::ceil((o.elevation_max_deg - o.elevation_min_deg) / o.params.elevation_step_deg - 1e-9);
    if (p.range > o.max_range_m || u >= cols || v < 0 || v >= rows) {
      ++counts.out_of_view;
      return;
    }
    const double row = std::floor(v);
    const double col = std::floor(u);
    cells[{static_cast<int>(row), static_cast<int>(col)}].push_back(
        {std::hypot(u - col - 0.5, v - row - 0.5), p.range});
  }
};

}  // namespace sweepcast::test
