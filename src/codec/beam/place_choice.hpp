// Which place of the lattice each point without a cell goes to: any within the error bound will do,
// and few places with round numbers of points take few bytes.
#pragma once

#include <span>
#include <vector>

#include "codec/beam/octree.hpp"

namespace sweepcast::beam {

/// The place nearest to a point; coordinates and `step` in metres. False where it lies outside the
/// lattice, or a coordinate is not finite.
[[nodiscard]] bool nearest_place(std::array<double, 3> xyz, double step, LatticePoint& place);

/// Chooses a place for each point, not farther from it than `max_error_m` once it is decoded, or
/// else the nearest. Points must have a nearest place.
void choose_places(std::span<const float> x, std::span<const float> y, std::span<const float> z,
                   double step, double max_error_m, std::vector<LatticePoint>& places);

}  // namespace sweepcast::beam
