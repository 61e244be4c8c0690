// The order of a cloud's points: firing by firing, or as it came.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sensor/beam_grid.hpp"

namespace sweepcast::beam {

/// Appends to `slots`, for each point of the image row by row, its place when points are ordered by
/// firing, those of a firing by row.
void firing_order(const BeamImage& image, std::vector<std::uint32_t>& next,
                  std::vector<std::uint32_t>& slots);

/// The original order of a cloud. An item is a point's cell in the image (row * cols + col), or the
/// number of cells plus its place among the extras, or `kDropped`: a slot whose point is not coded.
struct PointOrder {
  static constexpr std::uint32_t kDropped = 0xFFFFFFFF;
  std::vector<std::uint32_t> items;
  std::uint32_t width = 0;  ///< of an organised cloud, else 0; only then are slots dropped
};

/// The order of a cloud whose points are in `image` and, as indices into the cloud, in `extras`.
/// Organised where `width` is not 0 and divides the number of points.
[[nodiscard]] PointOrder original_order(std::size_t points, std::uint32_t width,
                                        const BeamImage& image,
                                        std::span<const std::uint32_t> extras);

/// Appends to `slots` the place of each point of the image, row by row, then of each extra.
void slots_of(const PointOrder& order, const BeamImage& image, std::size_t extras,
              std::vector<std::uint32_t>& slots);

/// Appends an order to `out`. Regular orders, in which a point of one row is followed by one of the
/// same other row, a fixed number of firings on, cost little; any other about log2(n) bits a point.
/// Every cell with a range and every extra must be in `order` once.
void write_order(const PointOrder& order, const BeamImage& image, std::size_t extras,
                 std::vector<std::byte>& out);

/// The inverse, for at most `most` items. False where it is no order of these cells and extras.
[[nodiscard]] bool read_order(std::span<const std::byte> bytes, const BeamImage& image,
                              std::size_t extras, std::size_t most, PointOrder& order);

}  // namespace sweepcast::beam
