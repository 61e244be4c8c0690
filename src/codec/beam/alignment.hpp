// The coded image: the beam image with its rows turned so that cells above each other look the same
// way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/beam/range_layers.hpp"
#include "sensor/beam_grid.hpp"
#include "sweepcast/sensor_model.hpp"

namespace sweepcast::beam {

/// For each row, the column of the coded image in which its cell of column 0 of the beam image
/// stands.
inline void find_first_columns(const SensorModel& model, const BeamImage& image,
                               std::vector<std::int32_t>& first) {
  column_shifts(model, image.firing_tick, first);
  for (std::int32_t& column : first) {
    column %= image.cols;
    if (column < 0) column += image.cols;
  }
}

/// Sets what encoder and decoder must agree on.
inline void set_plan(const SensorModel& model, int cols, int base_rows, int base_cols,
                     LayerPlan& plan) {
  plan.rows = static_cast<int>(model.beams.size());
  plan.cols = cols;
  const bool is_made = !plan.lattice.empty() && plan.lattice.front().row_stride == base_rows &&
                       plan.lattice.front().col_stride == base_cols;
  if (!is_made) plan.lattice = make_lattice(base_rows, base_cols);
  plan.elevation.clear();
  for (const Beam& beam : model.beams) plan.elevation.push_back(beam.tan_elevation);
}

/// Calls copy(cell of the beam image, cell of the coded image) for every cell. `first`: as
/// `find_first_columns` gives it.
template <class Copy>
void for_each_aligned(std::span<const std::int32_t> first, const BeamImage& image, Copy copy) {
  const auto cols = static_cast<std::size_t>(image.cols);
  for (std::size_t row = 0; row < first.size(); ++row) {
    const auto turned = static_cast<std::size_t>(first[row]);
    const std::size_t begin = row * cols;
    for (std::size_t col = 0; col < cols - turned; ++col) copy(begin + col, begin + turned + col);
    const std::size_t rest = begin + cols - turned;
    for (std::size_t col = 0; col < turned; ++col) copy(rest + col, begin + col);
  }
}

}  // namespace sweepcast::beam
