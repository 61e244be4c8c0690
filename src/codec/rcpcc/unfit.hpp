// The unfit image: the cells that no surface describes (section III.B.3 of the paper).
// Their ranges are transformed region by region and quantised, or kept to the millimetre.
#pragma once

#include <cstdint>
#include <vector>

#include "codec/rcpcc/sa_dct.hpp"
#include "core/bytes.hpp"
#include "sensor/spherical_grid.hpp"
#include "sweepcast/encoder.hpp"

namespace sweepcast::rcpcc {

struct UnfitOptions {
  int region_size = 4;
  std::int32_t step_mm = 200;  ///< q_step
  UnfitCoding coding = UnfitCoding::sa_dct;
  Rounding rounding = Rounding::nearest;
};

/// Codes the unfit cells; keeps its tables and buffers.
class UnfitCoder {
 public:
  /// Writes the occupied cells of `image` that are not `fitted` (one byte a cell).
  void write(const RangeImage& image, const std::vector<std::uint8_t>& fitted,
             const UnfitOptions& options, ByteWriter& out);

  /// Sets the occupied cells (not 0) of `image` that are not `fitted`. False where `in` ends early
  /// or holds values that no encoder writes.
  [[nodiscard]] bool read(ByteReader& in, const std::vector<std::uint8_t>& fitted,
                          const UnfitOptions& options, RangeImage& image);

 private:
  /// A region with unfit cells, and the place of its first coefficient among all.
  struct Region {
    int row, col;
    RegionShape shape;
    int cells;
    std::int32_t mean;  ///< in quantiser steps
  };

  void find_regions(const RangeImage& image, const std::vector<std::uint8_t>& fitted, int size);
  void write_transformed(const RangeImage& image, const UnfitOptions& options, ByteWriter& out);
  void write_raw(const RangeImage& image, ByteWriter& out) const;
  [[nodiscard]] bool read_transformed(ByteReader& in, const UnfitOptions& options,
                                      RangeImage& image);
  [[nodiscard]] bool read_raw(ByteReader& in, RangeImage& image) const;

  ShapeAdaptiveDct dct_;
  std::vector<Region> regions_;
};

}  // namespace sweepcast::rcpcc
