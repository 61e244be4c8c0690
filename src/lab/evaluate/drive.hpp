// What is known of a drive: its sweeps, and the truth that lies beside them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lab/odometry/rigid.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// The files of a drive, as `sweepcast simulate` names them. What is absent is empty.
struct DriveFiles {
  std::filesystem::path folder;
  std::vector<std::filesystem::path> sweeps;  ///< in the order of time
  /// One a sweep: the sensor at its last firing, in its frame at the first sweep's (poses.txt).
  std::vector<RigidTransform> poses;
  std::string poses_hash;                     ///< changes with them
  std::optional<std::filesystem::path> mesh;  ///< the true surface, in the same frame (mesh.ply)
  std::string sweeps_hash;                    ///< changes with the bytes of any sweep
};

/// Looks for truth in `folder`, and reads all sweeps once, for their hash.
/// Errors: not_found, io (a sweep); those of `read_poses`; invalid_argument (no sweep; fewer poses
/// than sweeps).
[[nodiscard]] Result<DriveFiles> open_drive(std::filesystem::path folder,
                                            std::vector<std::filesystem::path> sweeps);

/// The hash of a file's bytes. Errors: not_found, io, limit (over 1 GiB).
[[nodiscard]] Result<std::string> hash_file(const std::filesystem::path& file);

}  // namespace sweepcast::lab
