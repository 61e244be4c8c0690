// Range images for the tests of the stages.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/random.hpp"
#include "sensor/spherical_grid.hpp"

namespace sweepcast::test {

/// An image of steps of 0.5 degrees from elevation -10 and azimuth -30 upward.
inline RangeImage empty_image(int rows, int cols) {
  RangeImage image;
  image.grid = {-30'000'000, 500'000, -10'000'000, 500'000, rows, cols};
  image.range_mm.assign(image.grid.cells(), 0);
  image.offsets.assign(static_cast<std::size_t>(rows), {});
  return image;
}

/// Its cells filled by `range_m(row, col)` in metres; 0 leaves a cell empty.
template <class Range>
RangeImage image_of(int rows, int cols, Range range_m) {
  RangeImage image = empty_image(rows, cols);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      image.row(row)[col] = static_cast<std::int32_t>(std::lround(1000.0 * range_m(row, col)));
    }
  }
  return image;
}

/// A share of the cells emptied at random.
inline void thin(RangeImage& image, std::mt19937& random, double share) {
  for (std::int32_t& range : image.range_mm) {
    if (uniform(random, 0, 1) < share) range = 0;
  }
}

/// Range, in metres, of the plane n.p = distance at the centre of a cell of `empty_image`.
inline double range_to_plane(int row, int col, double nx, double ny, double nz, double distance) {
  const double azimuth = (-30 + 0.5 * (col + 0.5)) * std::numbers::pi / 180;
  const double elevation = (-10 + 0.5 * (row + 0.5)) * std::numbers::pi / 180;
  return distance / (nx * std::cos(elevation) * std::cos(azimuth) +
                     ny * std::cos(elevation) * std::sin(azimuth) + nz * std::sin(elevation));
}

}  // namespace sweepcast::test
