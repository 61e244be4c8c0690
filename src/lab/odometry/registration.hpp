// Where a sweep lies in the map: point-to-point ICP.
#pragma once

#include "lab/odometry/rigid.hpp"
#include "lab/odometry/voxel_map.hpp"

namespace sweepcast::lab {

struct RegistrationOptions {
  double max_distance_m = 6.0;  ///< farther neighbours do not count
  double kernel = 0.67;         ///< squared residual, m^2, at which a pair's weight is a quarter
  int max_iterations = 500;
  double convergence = 1e-4;  ///< length of a step (metres, radians) that ends the search
};

/// Moves `points` (in the sensor's frame) onto `map`, starting from `guess`: pairs each with the
/// map's nearest, and takes the Gauss-Newton step of the sum of residuals under a Geman-McClure
/// kernel, until the step is small (Vizzo et al., KISS-ICP, 2023, III.D).
/// Returns the sensor's pose in the map's frame; `guess` where the map or the pairs are none.
[[nodiscard]] RigidTransform register_points(const Points& points, const VoxelMap& map,
                                             const RigidTransform& guess,
                                             const RegistrationOptions& options);

}  // namespace sweepcast::lab
