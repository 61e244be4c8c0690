// A procedural town: what stands still in the simulated world.
#pragma once

#include <cstdint>
#include <vector>

#include "lab/simulate/mesh.hpp"
#include "lab/simulate/parts.hpp"
#include "lab/simulate/road.hpp"

namespace sweepcast::lab {

/// A boxed object: `pose` is centred under it, on the ground, x forward. World frame.
struct BoxedObject {
  Extent extent;
  Pose pose;
};

/// Surfaces in the world's frame: x and y along the streets, z up, metres.
struct Town {
  Terrain terrain;
  Mesh mesh;
  std::vector<BoxedObject> parked;  ///< object number i + 1 in the mesh's surfaces
};

/// Builds the town that a seed determines.
[[nodiscard]] Town build_town(std::uint64_t seed);

}  // namespace sweepcast::lab
