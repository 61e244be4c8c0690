// Stands in for the files that need libtorch where the build found none.
#include "lab/detect/detector.hpp"
#include "lab/detect/train_pillars.hpp"

namespace sweepcast::lab {

namespace {

tl::unexpected<Error> no_torch(const char* command) {
  return fail(ErrorCode::unsupported,
              std::string(command) +
                  ": this build has no libtorch to run a network on; install libtorch-dev, then "
                  "configure and build again, or take --detector clusters");
}

}  // namespace

Result<std::unique_ptr<Detector>> make_pillar_detector(const std::filesystem::path& /*weights*/) {
  return no_torch("detect");
}

Status train_pillars(std::span<const LabelledSweep> /*sweeps*/, const TrainOptions& /*options*/,
                     const std::filesystem::path& /*weights*/,
                     const std::function<void(int, double)>& /*progress*/) {
  return no_torch("train-detector");
}

}  // namespace sweepcast::lab
