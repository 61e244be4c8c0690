// Who finds boxes in sweeps.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "lab/detect/boxes.hpp"
#include "sweepcast/cloud.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// Finds cars and vans in one sweep. One thread at a time may use a detector.
class Detector {
 public:
  Detector() = default;
  virtual ~Detector() = default;
  Detector(const Detector&) = delete;
  Detector& operator=(const Detector&) = delete;

  /// Boxes in the sensor's frame, best score first. Points that are not finite are passed over, and
  /// only coordinates count. Errors: those of the means that it is built on.
  [[nodiscard]] virtual Result<std::vector<Box>> detect(const PointCloud& cloud) = 0;
};

/// Without weights: takes the ground away, joins what is left into clusters, and fits a box of a
/// car's size to each. docs/detection.md has the steps.
[[nodiscard]] Result<std::unique_ptr<Detector>> make_cluster_detector();

/// PointPillars (Lang et al., CVPR 2019) with the weights that `train_pillars` wrote.
/// Errors: not_found, io, corrupt, truncated (the weights' file), unsupported (a build without
/// libtorch, weights of another network).
[[nodiscard]] Result<std::unique_ptr<Detector>> make_pillar_detector(
    const std::filesystem::path& weights);

}  // namespace sweepcast::lab
