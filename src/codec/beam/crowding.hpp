// Where points lie so close together that many share a place of the extras' lattice, an octree
// takes fewer bytes for them than ranges do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "sensor/beam_grid.hpp"

namespace sweepcast::beam {

/// The range, 0.1 mm, within which points had better be extras, estimated from a sample of the
/// lattice's places; 0 where none had. `x`, `y`, `z`: the sweep's points, metres; `step`: of the
/// lattice, metres; `range_bytes`: what the image's ranges took.
[[nodiscard]] std::int32_t crowded_range(const BeamImage& image, std::span<const float> x,
                                         std::span<const float> y, std::span<const float> z,
                                         double step, std::size_t range_bytes);

}  // namespace sweepcast::beam
