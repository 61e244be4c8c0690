// Range images for codecs of pictures: 16-bit ranges over rows of elevations and columns of
// azimuth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/bytes.hpp"
#include "sweepcast/cloud.hpp"

namespace sweepcast::lab {

/// A row: points with z = rho * tan_elevation + height, rho = hypot(x, y).
struct RasterRow {
  std::int32_t tan_elevation = 0;  ///< 2^-16
  std::int32_t height_mm = 0;      ///< of the row's origin above the sensor's
};

inline constexpr std::size_t kMaxRasterRows = 1024;
inline constexpr std::size_t kMaxRasterColumns = 1 << 16;

/// A range image. A cell's point lies in the middle of its column, at its range from its row's
/// origin; column 0 begins behind the sensor, columns run counter-clockwise.
struct RangeRaster {
  std::vector<RasterRow> rows;  ///< from the highest elevation down
  std::size_t columns = 0;
  std::uint32_t unit_um = 1;          ///< of ranges, micrometres
  std::vector<std::uint16_t> ranges;  ///< rows x columns, row by row; 0: no point
};

/// A row for each beam of the sensor that the cloud's points show, as `estimate_sensor_model` finds
/// them; where it finds none, 64 uniform rows.
[[nodiscard]] std::vector<RasterRow> beam_rows(const PointCloud& cloud);

/// Rows at equal angles over the elevations of the cloud's finite points.
[[nodiscard]] std::vector<RasterRow> uniform_rows(const PointCloud& cloud, int count);

/// Puts each point into the row whose cone is nearest to it. Of several points in a cell the
/// nearest to the sensor stays. Left out: points that are not finite, on a row's origin, or
/// farther than 1 km. `raster.rows` (at least one) and `raster.columns` are given; ranges are
/// in steps of 2 mm, of more where the farthest point needs it.
void draw(const PointCloud& cloud, RangeRaster& raster);

/// The points of the cells whose value is at least `least`, row by row.
void to_cloud(const RangeRaster& raster, std::uint32_t least, PointCloud& cloud);

/// Gives cells of value 0 another that costs a codec of pictures little, where a mask tells them:
/// a straight line from the value to the left to that to the right. Rows without any repeat the one
/// above.
void fill_gaps(std::size_t columns, std::vector<std::uint16_t>& ranges);

/// Everything but the ranges.
void write_head(const RangeRaster& raster, ByteWriter& writer);

/// The inverse; ranges come back as zeros. False where the bytes cannot be right.
[[nodiscard]] bool read_head(ByteReader& reader, RangeRaster& raster);

}  // namespace sweepcast::lab
