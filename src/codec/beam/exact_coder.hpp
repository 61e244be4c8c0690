// What is missing from decoded coordinates to the file's own: makes the codec lossless.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sensor/beam_grid.hpp"
#include "sweepcast/cloud.hpp"

namespace sweepcast::beam {

/// Where points come from. In the order of the points: those of an image row by row, which move
/// along their beams, then those without a cell.
struct PointOrigins {
  std::vector<std::uint16_t> row;   ///< of each point; the number of rows for those without a cell
  std::vector<std::int32_t> range;  ///< of each point of the image, 0.1 mm, as the image has it
  std::vector<std::array<double, 3>> beam_m;  ///< by row: where the beam begins
};

/// The origins of an image's points and of `extras` more. A mount moves beams with their origins;
/// of a deskewed sweep's motion they know nothing.
[[nodiscard]] PointOrigins origins_of(const SensorModel* model, const BeamImage& image,
                                      std::size_t extras);

/// Appends what is missing from the coordinates of `decoded` to those of `truth`, to the bit.
/// Coordinates that are multiples of a millimetre or the like are coded as such, others by their
/// floats' bits. The coordinate in which a point moves most with its range comes first and tells
/// the others how far the range is off. Before that, where `ranges`, the true ones of the image's
/// points, are multiples of a unit of the sensor's, comes which multiple.
void write_exact(const PointCloud& decoded, const PointOrigins& origins, const PointCloud& truth,
                 std::span<const std::int32_t> ranges, std::vector<std::byte>& out);

/// The inverse: turns `cloud`, the decoded points, into the true ones. False where the bytes cannot
/// be right; `cloud` is then of no use.
[[nodiscard]] bool read_exact(std::span<const std::byte> bytes, const PointOrigins& origins,
                              PointCloud& cloud);

}  // namespace sweepcast::beam
