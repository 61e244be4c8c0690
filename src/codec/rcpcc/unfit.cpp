#include "codec/rcpcc/unfit.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "codec/rcpcc/symbols.hpp"

namespace sweepcast::rcpcc {
namespace {

std::int32_t quantise(float value, float step, Rounding rounding) {
  const float steps = value / step;
  if (rounding == Rounding::truncate) return static_cast<std::int32_t>(steps);
  return static_cast<std::int32_t>(std::floor(steps + 0.5F));
}

// Calls visit(row, column) for the cells of a shape, column by column from the first.
template <class Visit>
void for_each_cell(const RegionShape& shape, Visit visit) {
  for (int c = 0; c < shape.size; ++c) {
    for (std::uint32_t rows = shape.rows[static_cast<std::size_t>(c)]; rows != 0;
         rows &= rows - 1) {
      visit(std::countr_zero(rows), c);
    }
  }
}

// Calls visit(p, q) for the places of a shape's coefficients, row by row from the lowest frequency.
template <class Visit>
void for_each_coefficient(const RegionShape& shape, Visit visit) {
  const auto lengths = ShapeAdaptiveDct::row_lengths(shape);
  for (std::size_t p = 0; p < lengths.size() && lengths[p] != 0; ++p) {
    for (std::size_t q = 0; q < static_cast<std::size_t>(lengths[p]); ++q) visit(p, q);
  }
}

}  // namespace

void UnfitCoder::write(const RangeImage& image, const std::vector<std::uint8_t>& fitted,
                       const UnfitOptions& options, ByteWriter& out) {
  find_regions(image, fitted, options.region_size);
  if (options.coding == UnfitCoding::raw) {
    write_raw(image, out);
  } else {
    write_transformed(image, options, out);
  }
}

bool UnfitCoder::read(ByteReader& in, const std::vector<std::uint8_t>& fitted,
                      const UnfitOptions& options, RangeImage& image) {
  find_regions(image, fitted, options.region_size);
  return options.coding == UnfitCoding::raw ? read_raw(in, image)
                                            : read_transformed(in, options, image);
}

void UnfitCoder::find_regions(const RangeImage& image, const std::vector<std::uint8_t>& fitted,
                              int size) {
  regions_.clear();
  const SphericalGrid& grid = image.grid;
  for (int row = 0; row < grid.rows; row += size) {
    for (int col = 0; col < grid.cols; col += size) {
      Region region{row, col, {}, 0, 0};
      region.shape.size = size;
      const int row_end = std::min(size, grid.rows - row);
      const int col_end = std::min(size, grid.cols - col);
      for (int r = 0; r < row_end; ++r) {
        const std::int32_t* ranges = image.row(row + r) + col;
        const std::uint8_t* is_fitted = fitted.data() + (ranges - image.range_mm.data());
        for (int c = 0; c < col_end; ++c) {
          const bool unfit = ranges[c] != 0 && is_fitted[c] == 0;
          region.shape.rows[static_cast<std::size_t>(c)] |= static_cast<std::uint32_t>(unfit) << r;
          region.cells += static_cast<int>(unfit);
        }
      }
      if (region.cells != 0) regions_.push_back(region);
    }
  }
}

// All means first, each as the difference from the one before, then all coefficients: like beside
// like is what zstd can use.
void UnfitCoder::write_transformed(const RangeImage& image, const UnfitOptions& options,
                                   ByteWriter& out) {
  const auto step = static_cast<float>(options.step_mm);
  std::int32_t last = 0;
  for (Region& region : regions_) {
    std::int64_t sum = 0;
    for_each_cell(region.shape,
                  [&](int r, int c) { sum += image.row(region.row + r)[region.col + c]; });
    const auto mean = static_cast<float>(sum) / static_cast<float>(region.cells);
    region.mean = quantise(mean, step, options.rounding);
    put_value(out, region.mean - last);
    last = region.mean;
  }
  RegionValues values;
  for (const Region& region : regions_) {
    const float mean = static_cast<float>(region.mean) * step;
    for_each_cell(region.shape, [&](int r, int c) {
      values[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] =
          static_cast<float>(image.row(region.row + r)[region.col + c]) - mean;
    });
    dct_.forward(region.shape, values);
    for_each_coefficient(region.shape, [&](std::size_t p, std::size_t q) {
      put_value(out, quantise(values[p][q], step, options.rounding));
    });
  }
}

bool UnfitCoder::read_transformed(ByteReader& in, const UnfitOptions& options, RangeImage& image) {
  const auto step = static_cast<float>(options.step_mm);
  // A range or coefficient beyond this cannot have been written, and would overflow below.
  const std::int32_t largest = kLargestRange / options.step_mm * kLargestRegion + kLargestRegion;
  std::int32_t last = 0;
  for (Region& region : regions_) {
    const std::int32_t difference = get_value(in);
    if (!in.ok() || std::abs(static_cast<std::int64_t>(difference)) > largest) return false;
    last += difference;
    if (last < 0 || last > largest) return false;
    region.mean = last;
  }
  RegionValues values;
  for (const Region& region : regions_) {
    for_each_coefficient(region.shape, [&](std::size_t p, std::size_t q) {
      values[p][q] = static_cast<float>(get_value(in)) * step;
    });
    if (!in.ok()) return false;
    dct_.inverse(region.shape, values);
    const float mean = static_cast<float>(region.mean) * step;
    for_each_cell(region.shape, [&](int r, int c) {
      const float range = values[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] + mean;
      const float sane = std::clamp(range, 1.0F, static_cast<float>(kLargestRange));
      image.row(region.row + r)[region.col + c] = static_cast<std::int32_t>(sane + 0.5F);
    });
  }
  return true;
}

void UnfitCoder::write_raw(const RangeImage& image, ByteWriter& out) const {
  std::int32_t last = 0;
  for (const Region& region : regions_) {
    for_each_cell(region.shape, [&](int r, int c) {
      const std::int32_t range = image.row(region.row + r)[region.col + c];
      put_value(out, range - last);
      last = range;
    });
  }
}

bool UnfitCoder::read_raw(ByteReader& in, RangeImage& image) const {
  std::int64_t last = 0;
  bool sane = true;
  for (const Region& region : regions_) {
    for_each_cell(region.shape, [&](int r, int c) {
      last += get_value(in);
      sane = sane && last > 0 && last <= kLargestRange;
      image.row(region.row + r)[region.col + c] = sane ? static_cast<std::int32_t>(last) : 1;
    });
    if (!sane || !in.ok()) return false;
  }
  return true;
}

}  // namespace sweepcast::rcpcc
