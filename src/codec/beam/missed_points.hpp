// Where layers leave points out, some are far from all that the decoder then has: a pole, a lone
// far return.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/beam/plane.hpp"

namespace sweepcast::beam {

/// A range image row by row, and what the decoder has of it.
struct ThinnedImage {
  std::size_t cols = 0;
  double column_angle = 0;                  ///< between columns, radians
  std::span<const std::int32_t> elevation;  ///< of each row, tangent, 2^-24
  std::span<const std::int32_t> truth;      ///< ranges, 0.1 mm, 0 where there is no point
  std::span<const std::int32_t> decoded;    ///< ranges, 0.1 mm
  std::span<const CellState> state;         ///< decoded: ranges of measured and filled cells count
};

/// Cells whose points lie farther than `reach` (0.1 mm) from every point around them that the
/// decoder has, those filled in among them.
[[nodiscard]] std::vector<std::size_t> missed_cells(const ThinnedImage& image, std::int32_t reach);

}  // namespace sweepcast::beam
