// Paths of a sensor: files of them, and how far one lies from the truth.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "lab/odometry/rigid.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// Reads poses as KITTI writes them: a line a sweep, 12 numbers, a 3x4 matrix row by row that takes
/// points from the sensor's frame to that of the path. Lines may end in "\r\n"; empty ones count
/// not. Errors: not_found, io, corrupt (a line without 12 finite numbers, or whose rotation is
/// none).
[[nodiscard]] Result<std::vector<RigidTransform>> read_poses(const std::filesystem::path& file);

/// Writes them in the same form. Errors: io.
[[nodiscard]] Status write_poses(const std::filesystem::path& file,
                                 std::span<const RigidTransform> poses);

/// How far a path lies from the truth. Errors relative to distance are means over all stretches of
/// 100, 200, ... 800 m that start at every tenth sweep, as KITTI's odometry benchmark has them
/// (Geiger et al., Are we ready for autonomous driving?, CVPR 2012).
struct TrajectoryError {
  double translation_percent = 0.0;
  double rotation_deg_per_m = 0.0;
  int stretches = 0;                ///< 0 where the path is shorter than 100 m: no figures above
  double length_m = 0.0;            ///< of the true path
  double step_translation_m = 0.0;  ///< RMS error of the motion from one sweep to the next
  double step_rotation_deg = 0.0;   ///< the same of its rotation
};

/// Compares poses sweep by sweep; only relative motions count, so both may start anywhere.
/// Errors: invalid_argument (other numbers of poses, fewer than 2).
[[nodiscard]] Result<TrajectoryError> trajectory_error(std::span<const RigidTransform> truth,
                                                       std::span<const RigidTransform> estimate);

}  // namespace sweepcast::lab
