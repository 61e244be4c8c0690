// The order in which a range image is coded: coarse to fine, in steps that each halve the distance
// between rows or columns that are known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
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

/// Steps of the lattice that make up a layer, [first, last): layer 0 is the base with all rows of
/// its columns, each further layer the columns half way between.
[[nodiscard]] inline std::pair<std::uint32_t, std::uint32_t> steps_of(
    const std::vector<LatticeStep>& lattice, int layer) {
  std::uint32_t base = 1;
  while (base < lattice.size() && lattice[base].kind == LatticeStep::Kind::rows) ++base;
  if (layer == 0) return {0, base};
  const auto step = base + static_cast<std::uint32_t>(layer) - 1;
  return {step, step + 1};
}

/// Which rows and columns a step adds.
struct Traversal {
  int first_row = 0, row_stride = 1;
  int first_col = 0, col_stride = 1;

  explicit Traversal(const LatticeStep& step)
      : row_stride(step.row_stride), col_stride(step.col_stride) {
    if (step.kind == LatticeStep::Kind::columns) {
      first_col = step.col_stride;
      col_stride *= 2;
    } else if (step.kind == LatticeStep::Kind::rows) {
      first_row = step.row_stride;
      row_stride *= 2;
    }
  }
};

}  // namespace sweepcast::beam
