// What the town is made of. Every function adds one thing to the builder's mesh, in the builder's
// frame: x along the street, y away from the viewer unless said otherwise, z up, metres, the
// origin on the ground. Where a thing varies from one to the next, `random` decides how.
#pragma once

#include <string_view>

#include "lab/random.hpp"
#include "lab/simulate/mesh.hpp"
#include "lab/simulate/road.hpp"

namespace sweepcast::lab {

// ground.cpp
/// Carriageways: a draped grid over the whole town. World frame.
void add_carriageways(MeshBuilder builder, const Terrain& terrain);
/// Kerb, pavement and yard of the block whose middle is (x, y). World frame.
void add_block_ground(MeshBuilder builder, const Terrain& terrain, double x, double y,
                      Random& random);
/// Dashes and crossings painted on the street that runs `along_x`, or along y, from the crossing at
/// (x, y) to the next one. World frame.
void add_markings(MeshBuilder builder, const Terrain& terrain, double x, double y, bool along_x);

// buildings.cpp
struct House {
  double width = 12.0;  ///< the facade runs from x = 0 to width at y = 0
  double depth = 11.0;  ///< and the house from there to y = depth
  double chamfer =
      0.0;  ///< cut off the corner at x = width (a house at a crossing), seen as facade
  double footing = 1.0;  ///< walls reach this far below the origin
  int storeys = 3;
  bool detailed = true;  ///< windows, doors and what else a beam would see
};
void add_house(MeshBuilder builder, const House& house, Random& random);
/// A garden wall or railing from x = 0 to width.
void add_fence(MeshBuilder builder, double width, Random& random);

// greenery.cpp
void add_tree(MeshBuilder builder, Random& random);
/// A hedge from x = 0 to width.
void add_hedge(MeshBuilder builder, double width, Random& random);
void add_bush(MeshBuilder builder, Random& random);

// furniture.cpp
/// A street lamp whose arm reaches towards -y.
void add_lamp(MeshBuilder builder, Random& random);
/// A traffic sign that faces -x.
void add_sign(MeshBuilder builder, Random& random);
void add_traffic_light(MeshBuilder builder);
void add_bollard(MeshBuilder builder);
/// A bin, a cabinet or a bench.
void add_furniture(MeshBuilder builder, Random& random);

// road_users.cpp
/// The box of a thing that has one: centred on the origin, standing on it, x forward.
struct Extent {
  std::string_view kind;
  double length = 0.0;
  double width = 0.0;
  double height = 0.0;
};
[[nodiscard]] Extent add_car(MeshBuilder builder, Random& random);
[[nodiscard]] Extent add_pedestrian(MeshBuilder builder, Random& random);

}  // namespace sweepcast::lab
