// Surfaces: macroblocks of the range image that a model of three coefficients describes
// (section III.B.2 of the paper): finding them, turning them into ranges again, and their bytes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/bytes.hpp"
#include "sensor/spherical_grid.hpp"
#include "sweepcast/encoder.hpp"

namespace sweepcast::rcpcc {

/// The three numbers of a surface, in units of `SurfaceSteps`. With u and v the columns and rows
/// from the centre of the run's first block, the surface model is
///     r = r0^2 / (r0 + gu u + gv v),
/// the paper's equation 4 with d = -r0^2, a = gu, b = gv, c = r0: r0 is the range at that centre,
/// gu and gv are how much the range falls from one column and from one row to the next. The plane
/// model (equation 3) has the same three numbers; see `Terms` in surface.cpp.
struct Coefficients {
  std::int32_t range = 0;
  std::int32_t slope_u = 0;
  std::int32_t slope_v = 0;

  [[nodiscard]] bool operator==(const Coefficients&) const = default;
};

/// A macroblock: `row` counts rows of blocks from the lowest, `col` blocks from column 0.
struct Block {
  std::int32_t row = 0;
  std::int32_t col = 0;
};

/// Lists the blocks that hold a point, row by row, into `blocks`.
void list_occupied_blocks(const RangeImage& image, int block_size, std::vector<Block>& blocks);

/// The paper's four-tuple (row, col, len, coefficients): a run of blocks in one row of blocks.
/// `first` is an index into the list of occupied blocks, which says row and col; `length` counts
/// occupied blocks, so that the empty ones between them cost nothing.
struct Surface {
  std::uint32_t first = 0;
  std::uint32_t length = 0;
  Coefficients coefficients;

  [[nodiscard]] bool operator==(const Surface&) const = default;
};

/// What one unit of each coefficient is worth, millimetres (per column or row for the slopes):
/// fine enough that rounding takes a small part of the threshold.
struct SurfaceSteps {
  double range = 1.0;
  double slope = 1.0;

  [[nodiscard]] static SurfaceSteps of(std::int32_t threshold_mm, int block_size);
};

struct SurfaceOptions {
  int block_size = 4;
  std::int32_t threshold_mm = 300;  ///< delta r
  SurfaceModel model = SurfaceModel::surface;
};

/// A cell with a point.
struct OccupiedCell {
  std::int32_t row, col;
  std::int32_t range_mm;
};

/// Finds surfaces; keeps its buffers.
class SurfaceFitter {
 public:
  /// Fills `surfaces`, in the order of `blocks`, the occupied blocks of `image`. Every occupied
  /// cell of a surface's blocks differs from what `paint_surfaces` gives by at most the threshold.
  void fit(const RangeImage& image, std::span<const Block> blocks, const SurfaceOptions& options,
           std::vector<Surface>& surfaces);

 private:
  std::vector<OccupiedCell> block_;  ///< of the block at hand
  std::vector<OccupiedCell> run_;    ///< of the run, that block included
  std::size_t first_cells_ = 0;      ///< cells of the run's first block
};

/// Writes the ranges that the surfaces give into the occupied cells (those not 0) of their blocks,
/// and marks those cells in `fitted`: one byte a cell, 1 where fitted.
/// False where a surface gives no range, as only a damaged one does.
[[nodiscard]] bool paint_surfaces(std::span<const Surface> surfaces, std::span<const Block> blocks,
                                  const SurfaceOptions& options, RangeImage& image,
                                  std::vector<std::uint8_t>& fitted);

/// Writes the surfaces: for each the occupied blocks since the one before and its length, then all
/// ranges as differences, then all slopes.
void write_surfaces(std::span<const Surface> surfaces, ByteWriter& out);

/// The inverse of `write_surfaces`. False unless every surface is a run of blocks in one row.
[[nodiscard]] bool read_surfaces(ByteReader& in, std::span<const Block> blocks,
                                 std::vector<Surface>& surfaces);

}  // namespace sweepcast::rcpcc
