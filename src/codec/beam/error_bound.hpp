// How an error bound is shared out between angles, ranges and points without a cell.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sweepcast/sensor_model.hpp"

namespace sweepcast::beam {

/// Share of the bound that angles may take, the rest being the ranges'. Errors across and along a
/// beam are at right angles, so that these 15 % cost the ranges one per cent of the bound.
inline constexpr double kAngularShare = 0.15;

/// Half the step of ranges, metres: what angles leave, less the rounding of ranges to 0.1 mm and of
/// coordinates to float32.
[[nodiscard]] inline double range_error(double max_error_m) {
  constexpr double kRounding = 0.6e-4;
  return max_error_m * std::sqrt(1.0 - kAngularShare * kAngularShare) - kRounding;
}

/// The step of ranges, 0.1 mm.
[[nodiscard]] inline std::int32_t range_step(double max_error_m) {
  return std::max(1, static_cast<std::int32_t>(2.0 * range_error(max_error_m) * kRangeUnits));
}

/// The step of the lattice of points without a cell, 0.1 mm: half a cube's diagonal is the bound.
[[nodiscard]] inline std::int32_t extras_step(double max_error_m) {
  constexpr double kHalfDiagonal = 0.8660254037844387;
  return std::max(1, static_cast<std::int32_t>(max_error_m / kHalfDiagonal * kRangeUnits));
}

}  // namespace sweepcast::beam
