// What moves: cars on the loop, in both directions, and people on the pavements.
#pragma once

#include <cstdint>
#include <vector>

#include "lab/simulate/mesh.hpp"
#include "lab/simulate/parts.hpp"
#include "lab/simulate/road.hpp"
#include "lab/simulate/town.hpp"

namespace sweepcast::lab {

/// Speed of the sensor's car and of those that drive in its lane.
inline constexpr double kSpeed = 10.0;  // metres a second

/// One moving thing: a shape in its own frame, and how it moves along the loop.
struct Mover {
  Mesh shape;  ///< local frame: x forward, z up, the origin under its middle
  Extent extent;
  double start = 0.0;    ///< metres along the loop at time 0; a walker's turning point
  double speed = 0.0;    ///< metres a second along the loop; negative: against it
  double left = 0.0;     ///< metres beside the loop
  double stretch = 0.0;  ///< a walker goes this far and comes back; 0: round and round
  double lift = 0.0;     ///< above the road: the pavement's height

  /// Where it is `seconds` from the drive's start. World frame.
  [[nodiscard]] Pose at(double seconds, const Loop& loop, const Terrain& terrain) const;
};

/// The movers that a seed determines; their surfaces' object numbers follow `first_object`.
[[nodiscard]] std::vector<Mover> build_traffic(std::uint64_t seed, const Loop& loop,
                                               std::uint16_t first_object);

}  // namespace sweepcast::lab
