// Where a sensor has measured something.
#pragma once

#include <tsl/robin_map.h>

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "lab/mesh/sweep_rays.hpp"
#include "lab/odometry/voxel_map.hpp"

namespace sweepcast::lab {

/// Remembers in which cubes of space rays ended: a bit a cube.
class SeenSpace {
 public:
  /// Cubes of 5 cm: what lies farther than 18 cm from all ends is not seen.
  explicit SeenSpace(double cube_m = 0.05) : cube_m_(cube_m) {}

  void add(std::span<const Ray> rays);

  /// Whether some ray ended in the point's cube or one of its 26 neighbours: true within a cube's
  /// edge of an end, false beyond 2 sqrt(3) edges.
  [[nodiscard]] bool is_seen(const Eigen::Vector3d& point) const;

 private:
  double cube_m_;
  tsl::robin_map<Voxel, std::uint64_t, VoxelHash> blocks_;  ///< of 4 x 4 x 4 cubes
};

}  // namespace sweepcast::lab
