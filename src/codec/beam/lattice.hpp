// The order in which a range image is coded: coarse to fine, in steps that each halve the distance
// between rows or columns that are known.
#pragma once

#include <cstdint>
#include <vector>

namespace sweepcast::beam {

/// Which cells a step adds.
struct LatticeStep {
  enum class Kind : std::uint8_t {
    base,     ///< every `row_stride`-th row and `col_stride`-th column, in raster order
    columns,  ///< the columns half way between those known, in the rows known
    rows,     ///< the rows half way between those known, in the columns known
  };
  Kind kind = Kind::base;
  int row_stride = 1;  ///< after the step
  int col_stride = 1;
};

/// The steps from a base of the given strides (powers of two) to every cell: rows first while the
/// columns are coarse, then columns.
[[nodiscard]] inline std::vector<LatticeStep> make_lattice(int row_stride, int col_stride) {
  std::vector<LatticeStep> steps{{LatticeStep::Kind::base, row_stride, col_stride}};
  while (row_stride > 1) {
    row_stride /= 2;
    steps.push_back({LatticeStep::Kind::rows, row_stride, col_stride});
  }
  while (col_stride > 1) {
    col_stride /= 2;
    steps.push_back({LatticeStep::Kind::columns, row_stride, col_stride});
  }
  return steps;
}

}  // namespace sweepcast::beam
