// A cloud as PointPillars' network takes it: points with features, by pillars of a grid on the
// ground (Lang et al., PointPillars, CVPR 2019, 2.1). Knows no network.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sweepcast/cloud.hpp"

namespace sweepcast::lab {

/// The grid: square pillars, the sensor in the middle. Rows go along y, columns along x.
struct PillarGrid {
  static constexpr int kSide = 256;        ///< pillars in a row and in a column
  static constexpr float kSize = 0.4F;     ///< metres
  static constexpr float kReach = 51.2F;   ///< kSide * kSize / 2
  static constexpr float kLowest = -6.0F;  ///< z of points that count, metres
  static constexpr float kHighest = 4.0F;
  static constexpr int kMostPoints = 32;  ///< of a pillar; of more, these are taken evenly
};

/// Numbers that the network gets of a point: x, y, z; offsets from the mean of its pillar's points
/// (3); from the pillar's middle (2). Lengths are scaled so that most lie within 1. The paper has
/// intensity beside them; coded sweeps often come without it.
inline constexpr int kPointFeatures = 8;

/// Points by pillar.
struct Pillars {
  std::vector<float> features;      ///< kPointFeatures for each point, pillar by pillar
  std::vector<std::int64_t> owner;  ///< of each point: index of its pillar, rising
  std::vector<std::int64_t> cell;   ///< of each pillar: row * kSide + column, rising
};

/// Sorts points into pillars; those outside the grid, or not finite, are passed over.
[[nodiscard]] Pillars make_pillars(std::span<const float> x, std::span<const float> y,
                                   std::span<const float> z);

}  // namespace sweepcast::lab
