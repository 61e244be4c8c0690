// A simulated drive as a folder of files; docs/simulator.md describes them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "lab/simulate/simulate.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

struct ExportOptions {
  bool kitti = false;  ///< sweeps as .bin (x, y, z, intensity) instead of .pcd
  bool force = false;  ///< replace a drive that is there
  int threads = 0;     ///< sweeps made at a time; 0: one a core. Files do not depend on it.
};

struct ExportSummary {
  int sweeps = 0;
  std::size_t points = 0;     ///< in all sweeps
  std::size_t boxes = 0;      ///< in all sweeps
  std::size_t triangles = 0;  ///< in mesh.ply
};

/// Writes sweeps/, boxes/, poses.txt, mesh.ply and sensor.json into `folder`. They are written
/// beside it first and moved there at the end, so that a drive is there whole or not at all.
/// `progress` is called after each sweep, by one thread at a time.
/// Errors: invalid_argument (the folder holds something and `force` is not set, or is a file), io.
[[nodiscard]] Result<ExportSummary> write_drive(const Drive& drive,
                                                const std::filesystem::path& folder,
                                                const ExportOptions& options,
                                                const std::function<void()>& progress = {});

}  // namespace sweepcast::lab
