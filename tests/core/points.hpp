// Shorthands for clouds in tests.
#pragma once

#include <cstdint>

#include "sweepcast/cloud.hpp"
#include "sweepcast/frame.hpp"

namespace sweepcast::test {

inline void add_point(PointCloud& cloud, double x, double y, double z) {
  cloud.x.push_back(static_cast<float>(x));
  cloud.y.push_back(static_cast<float>(y));
  cloud.z.push_back(static_cast<float>(z));
}

/// What became of the points that came in; their number, if none was forgotten.
inline std::uint32_t sum_without_input(const SweepCounts& c) {
  return c.points_coded + c.not_finite + c.zero_range + c.cropped + c.out_of_view + c.collided +
         c.thinned;
}

}  // namespace sweepcast::test
