// The paper's range image: a uniform grid over azimuth and elevation (section III.B.1).
// Cloud -> image and back; `unproject` is the inverse of `project` up to what the grid cannot hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sweepcast/cloud.hpp"
#include "sweepcast/encoder.hpp"
#include "sweepcast/frame.hpp"

namespace sweepcast {

/// Where the cells lie. Angles are integers, in millionths of a degree, so that a frame says them
/// exactly. Row 0 is the lowest, column 0 begins at `azimuth_min`.
struct SphericalGrid {
  std::int32_t azimuth_min = -180'000'000;
  std::int32_t azimuth_step = 500'000;
  std::int32_t elevation_min = -90'000'000;  ///< lower edge of row 0
  std::int32_t elevation_step = 500'000;
  int rows = 0;
  int cols = 0;

  [[nodiscard]] std::size_t cells() const {
    return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  }
};

/// Where in their cells the points of a row lie on average, in 1/256 of a step from the centre.
/// Decoding at the centre instead would turn and tilt the cloud: the rows of the grid and the
/// beams of a sensor do not coincide.
struct RowOffset {
  std::int8_t azimuth = 0;
  std::int8_t elevation = 0;
};

/// Ranges in millimetres, row by row; 0 where a cell is empty.
struct RangeImage {
  SphericalGrid grid;
  std::vector<std::int32_t> range_mm;  ///< grid.cells() values
  std::vector<RowOffset> offsets;      ///< grid.rows values

  [[nodiscard]] const std::int32_t* row(int r) const {
    return range_mm.data() + static_cast<std::size_t>(r) * static_cast<std::size_t>(grid.cols);
  }
  [[nodiscard]] std::int32_t* row(int r) {
    return range_mm.data() + static_cast<std::size_t>(r) * static_cast<std::size_t>(grid.cols);
  }
};

/// Makes range images; keeps its buffers.
class SphericalProjector {
 public:
  /// Options must be valid (`Encoder::create` checks them).
  SphericalProjector(const RcpccOptions& options, const Crop& crop);

  /// Fills `image` with the points of `cloud`: the rows from the lowest to the highest with a
  /// point, all columns. Every point is counted in exactly one member of `counts`.
  void project(const CloudView& cloud, RangeImage& image, SweepCounts& counts);

 private:
  struct Batch;

  /// One point in the grid.
  struct Sample {
    std::int32_t range_mm;
    std::uint16_t row, col;
    std::int8_t azimuth, elevation;  ///< from the cell's centre, 1/256 step
  };

  void to_spherical(const CloudView& cloud, std::size_t begin, Batch& batch) const;
  void collect(const Batch& batch, SweepCounts& counts);
  [[nodiscard]] bool wins(const Sample& a, const Sample& b) const;
  void scatter(RangeImage& image, SweepCounts& counts);

  Crop crop_;
  SphericalGrid view_;  ///< the whole field of view
  CollisionRule collision_;
  float max_range_;
  std::vector<Sample> samples_;
  std::vector<std::uint32_t> winner_;  ///< per cell: index into samples_ plus 1; 0 is empty
};

/// Makes clouds of range images; keeps its tables.
class SphericalUnprojector {
 public:
  /// Fills the coordinates of `cloud`, row by row, one point for each occupied cell; the other
  /// columns come back empty.
  void unproject(const RangeImage& image, PointCloud& cloud);

 private:
  std::vector<double> sin_, cos_;  ///< of the columns' centres
};

}  // namespace sweepcast
