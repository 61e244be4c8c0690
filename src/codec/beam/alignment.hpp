// The coded image: the beam image with its rows turned so that cells above each other look the same
// way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/beam/range_layers.hpp"
#include "sensor/beam_grid.hpp"
#include "sweepcast/sensor_model.hpp"

namespace sweepcast::beam {

/// Column of the coded image in which cell (row, column 0) of the beam image stands.
[[nodiscard]] inline std::vector<std::int32_t> first_columns(const SensorModel& model,
                                                             const BeamImage& image) {
  std::vector<std::int32_t> shift;
  column_shifts(model, image.firing_tick, shift);
  for (std::int32_t& s : shift) {
    s %= image.cols;
    if (s < 0) s += image.cols;
  }
  return shift;
}

/// Sets what encoder and decoder must agree on.
inline void set_plan(const SensorModel& model, int cols, int base_rows, int base_cols,
                     LayerPlan& plan) {
  plan.rows = static_cast<int>(model.beams.size());
  plan.cols = cols;
  plan.lattice = make_lattice(base_rows, base_cols);
  plan.elevation.clear();
  for (const Beam& beam : model.beams) plan.elevation.push_back(beam.tan_elevation);
}

/// Calls copy(row, cell of the beam image, cell of the coded image) for every cell.
template <class Copy>
void for_each_aligned(const SensorModel& model, const BeamImage& image, Copy copy) {
  const std::vector<std::int32_t> first = first_columns(model, image);
  for (int row = 0; row < image.rows; ++row) {
    int aligned = first[static_cast<std::size_t>(row)];
    const std::size_t begin = static_cast<std::size_t>(row) * static_cast<std::size_t>(image.cols);
    for (int col = 0; col < image.cols; ++col) {
      copy(row, begin + static_cast<std::size_t>(col), begin + static_cast<std::size_t>(aligned));
      if (++aligned == image.cols) aligned = 0;
    }
  }
}

}  // namespace sweepcast::beam
