// The order in which a driver went through the cells of a range image.
#pragma once

#include <cstdint>
#include <vector>

#include "codec/beam/point_order.hpp"
#include "core/bytes.hpp"
#include "sensor/beam_grid.hpp"

namespace sweepcast::beam {

/// How the sensor's driver went through rows and firings: ring by ring, or firing by firing.
struct Schedule {
  bool by_ring = false;
  bool backwards = false;                   ///< columns fall
  std::vector<std::uint32_t> rows;          ///< in their order
  std::vector<std::uint32_t> first_column;  ///< by row: where it begins
};

/// The schedule that foresees most of an order.
[[nodiscard]] Schedule schedule_of(const PointOrder& order, const BeamImage& image);

/// All cells (row * cols + col) in the order of a schedule.
[[nodiscard]] std::vector<std::uint32_t> cells_in_order(const Schedule& schedule,
                                                        std::uint32_t cols);

void write_schedule(const Schedule& schedule, ByteWriter& out);

/// The inverse; false where it is none of `rows` rows and `cols` columns.
[[nodiscard]] bool read_schedule(ByteReader& in, std::uint32_t rows, std::uint32_t cols,
                                 Schedule& schedule);

}  // namespace sweepcast::beam
