// The sweeps that a command line names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sweepcast/cloud_file.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::app {

/// Turns the INPUT arguments into cloud files: a file stands for itself, a folder for the .bin,
/// .pcd and .ply files in it, ordered by name. A drive made by `simulate` (a folder with `sweeps/`
/// in it) stands for its sweeps, and so does a KITTI folder (`velodyne/`, `velodyne_points/data/`).
/// Other files in a folder, and those whose name begins with a dot, are passed over.
/// Errors: not_found (no such path), io (a folder that cannot be read), invalid_argument (no cloud
/// in a folder, another file type, mixed types in a folder, two inputs of the same base name), each
/// naming the path and the remedy.
[[nodiscard]] Result<std::vector<std::filesystem::path>> collect_clouds(
    const std::vector<std::string>& inputs);

/// Refuses an output that is one of what the command reads (empty paths count not), which it would
/// overwrite. Errors: invalid_argument.
[[nodiscard]] Status check_output(const std::filesystem::path& output,
                                  const std::vector<std::filesystem::path>& reads);

}  // namespace sweepcast::app
