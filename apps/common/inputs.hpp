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
/// in it) stands for its sweeps.
/// Errors: not_found (no such path), invalid_argument (no cloud in a folder, another file type,
/// mixed types), each naming the path and the remedy.
[[nodiscard]] Result<std::vector<std::filesystem::path>> collect_clouds(
    const std::vector<std::string>& inputs);

}  // namespace sweepcast::app
