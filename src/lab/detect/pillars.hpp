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
/// (3); from the pillar's middle (2); and `age`. Lengths are scaled so that most lie within 1. The
/// paper has intensity in place of age; coded sweeps often come without it.
inline constexpr int kPointFeatures = 9;

/// Points by pillar.
struct Pillars {
  std::vector<float> features;      ///< kPointFeatures for each point, pillar by pillar
  std::vector<std::int64_t> owner;  ///< of each point: index of its pillar, rising
  std::vector<std::int64_t> cell;   ///< of each pillar: row * kSide + column, rising
};

/// Age of a point: the share of a sweep, 0 to 1, that passes from its firing to the last one, of a
/// sensor that turns clockwise and begins at the rear. Of `as_met` sweeps it is 0.
[[nodiscard]] float age_of(float x, float y);

/// Sorts points into pillars; those outside the grid, or not finite, are passed over. `ages` is as
/// long as `x`, or empty: all 0.
[[nodiscard]] Pillars make_pillars(std::span<const float> x, std::span<const float> y,
                                   std::span<const float> z, std::span<const float> ages);

}  // namespace sweepcast::lab
