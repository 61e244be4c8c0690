// Leaving out points that the caller does not want.
#pragma once

#include "sweepcast/encoder.hpp"

namespace sweepcast {

/// Whether the crop can leave anything out.
[[nodiscard]] inline bool crops(const Crop& crop) {
  return crop.min_range > 0.0F || crop.max_range > 0.0F || crop.keep || crop.robot;
}

[[nodiscard]] inline bool is_inside(const Box& box, float x, float y, float z) {
  return x >= box.min_x && x <= box.max_x && y >= box.min_y && y <= box.max_y && z >= box.min_z &&
         z <= box.max_z;
}

/// Whether the crop leaves out a point at (x, y, z), `range` metres away.
[[nodiscard]] inline bool is_cropped(const Crop& crop, float x, float y, float z, float range) {
  if (range < crop.min_range) return true;
  if (crop.max_range > 0.0F && range > crop.max_range) return true;
  if (crop.keep && !is_inside(*crop.keep, x, y, z)) return true;
  return crop.robot && is_inside(*crop.robot, x, y, z);
}

}  // namespace sweepcast
