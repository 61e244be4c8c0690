// The occupancy mask: which cells of the range image hold a point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/bytes.hpp"

namespace sweepcast::rcpcc {

/// Writes the mask of `range_mm` (0 is empty) as lengths of runs, row after row, in turns: empty,
/// occupied, empty, and so on; the first may be 0.
void write_occupancy(std::span<const std::int32_t> range_mm, ByteWriter& out);

/// Sets every occupied cell of `range_mm` to 1 and the others to 0. The inverse of
/// `write_occupancy`; false unless the runs fill the image to the last cell.
[[nodiscard]] bool read_occupancy(ByteReader& in, std::span<std::int32_t> range_mm);

}  // namespace sweepcast::rcpcc
