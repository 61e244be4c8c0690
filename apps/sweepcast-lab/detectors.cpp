#include "sweepcast-lab/detectors.hpp"

#include <system_error>

namespace sweepcast::app {

std::filesystem::path shipped_weights() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  return program.parent_path() / "pointpillars.weights";
}

Result<std::unique_ptr<lab::Detector>> make_detector(const std::string& name,
                                                     const std::filesystem::path& weights) {
  if (name == "clusters") return lab::make_cluster_detector();
  return lab::make_pillar_detector(weights.empty() ? shipped_weights() : weights);
}

}  // namespace sweepcast::app
