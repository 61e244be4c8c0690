// Distortion as a task: how far decoded points are from the originals.
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "lab/distortion.hpp"
#include "lab/evaluate/tasks.hpp"

namespace sweepcast::lab {
namespace {

constexpr std::size_t kDistortionEvery = 5;

/// What every codec is compared with, prepared once where there are few sweeps: a reference of
/// 120,000 points takes about 15 MB.
class References {
 public:
  explicit References(std::size_t sweeps) : keeps_(sweeps <= kMostKept) {}

  std::shared_ptr<const Reference> of(std::size_t index, const PointCloud& original) {
    if (!keeps_) return std::make_shared<const Reference>(original);
    {
      const std::scoped_lock lock(mutex_);
      const auto found = kept_.find(index);
      if (found != kept_.end()) return found->second;
    }
    auto made = std::make_shared<const Reference>(original);
    const std::scoped_lock lock(mutex_);
    return kept_.emplace(index, std::move(made)).first->second;
  }

 private:
  static constexpr std::size_t kMostKept = 40;
  bool keeps_;
  std::mutex mutex_;
  std::map<std::size_t, std::shared_ptr<const Reference>> kept_;
};

class DistortionRun : public TaskRun {
 public:
  explicit DistortionRun(References& references) : references_(references) {}

  Status add(const SweepPair& sweep) override {
    mean_.add(references_.of(sweep.index, sweep.original)->compare(sweep.decoded));
    return {};
  }

  Result<Figures> finish() override {
    const Distortion mean = mean_.mean();
    Figures figures;
    for (std::size_t i = 0; i < kFScoreNames.size(); ++i) {
      figures.push_back({"f_score." + std::string(kFScoreNames[i]), mean.f_score[i]});
    }
    figures.push_back({"d1_psnr", mean.d1_psnr});
    figures.push_back({"d2_psnr", mean.d2_psnr});
    return figures;
  }

 private:
  References& references_;
  DistortionMean mean_;
};

class DistortionTask : public Task {
 public:
  DistortionTask(std::size_t sweeps, std::size_t every)
      : Task("distortion", "every " + std::to_string(every), every),
        references_(std::make_unique<References>((sweeps + every - 1) / every)) {}

  Result<std::unique_ptr<TaskRun>> begin() const override {
    return std::make_unique<DistortionRun>(*references_);
  }

 private:
  std::unique_ptr<References> references_;
};

}  // namespace

Result<std::unique_ptr<const Task>> make_distortion_task(const DriveFiles& drive,
                                                         const TaskOptions& options) {
  return std::make_unique<DistortionTask>(drive.sweeps.size(), options.full ? 1 : kDistortionEvery);
}

}  // namespace sweepcast::lab
