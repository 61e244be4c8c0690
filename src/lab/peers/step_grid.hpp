// Points on a grid of equal steps, for codecs of whole numbers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/bytes.hpp"
#include "sweepcast/cloud.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

using GridCell = std::array<std::uint32_t, 3>;

inline constexpr std::uint32_t kGridSteps = 1U << 21;  ///< cells along an axis, at most
inline constexpr std::uint32_t kMaxStepUm = 100'000'000;

/// Points as whole steps from a corner. A point decodes at its cell's centre, so that it misses its
/// place by at most half a cube's diagonal.
struct StepGrid {
  std::uint32_t step_um = 1;             ///< micrometres
  std::array<std::int64_t, 3> corner{};  ///< the lowest cell, in steps; those are multiples of it
  std::vector<GridCell> cells;           ///< from the corner, each below kGridSteps
};

/// A step in metres as whole micrometres, in `what`'s name. Error: invalid_argument (outside 1 um
/// to 100 m).
[[nodiscard]] Result<std::uint32_t> step_um_of(double step_m, const char* what);

/// Puts points on a grid, in their order. Left out: points that are not finite, or 2^20 steps or
/// more from the sensor along an axis.
void to_grid(const PointCloud& cloud, std::uint32_t step_um, StepGrid& grid);

/// The points at the cells' centres.
void to_cloud(const StepGrid& grid, PointCloud& cloud);

/// Everything but the cells.
void write_head(const StepGrid& grid, ByteWriter& writer);

/// The inverse. False where the bytes cannot be right.
[[nodiscard]] bool read_head(ByteReader& reader, StepGrid& grid);

}  // namespace sweepcast::lab
