// Detection as a task: how well cars are found in decoded sweeps.
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "lab/detect/average_precision.hpp"
#include "lab/detect/boxes.hpp"
#include "lab/detect/detector.hpp"
#include "lab/detect/labels.hpp"
#include "lab/evaluate/content_hash.hpp"
#include "lab/evaluate/tasks.hpp"

namespace sweepcast::lab {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDetectionEvery = 2;

/// Where true boxes lie in a drive: as `simulate` writes them, and as KITTI has them.
constexpr std::array<const char*, 2> kFolders{"boxes", "label_2"};

/// What all settings share.
struct DetectionSetup {
  std::vector<Labels> truth;  ///< [sweep]; empty for sweeps that are not taken
  fs::path weights;           ///< empty: the detector without

  [[nodiscard]] Result<std::unique_ptr<Detector>> detector() const {
    return weights.empty() ? make_cluster_detector() : make_pillar_detector(weights);
  }
};

class DetectionRun : public TaskRun {
 public:
  DetectionRun(const DetectionSetup& setup, std::unique_ptr<Detector> detector)
      : setup_(setup), detector_(std::move(detector)) {}

  Status add(const SweepPair& sweep) override {
    auto found = detector_->detect(sweep.decoded);
    if (!found) return tl::unexpected(std::move(found.error()));
    const Labels& labels = setup_.truth[sweep.index];
    std::vector<Box> boxes = labels.boxes;
    if (std::any_of(boxes.begin(), boxes.end(), [](const Box& box) { return box.points < 0; })) {
      count_points(sweep.original, boxes);
    }
    if (labels.is_labelled) {
      std::erase_if(*found, [&](const Box& box) { return !labels.is_labelled(box.centre); });
    }
    truth_.push_back(std::move(boxes));
    found_.push_back(std::move(*found));
    return {};
  }

  Result<Figures> finish() override {
    const DetectionScore score = detection_score(truth_, found_);
    return Figures{{"bev_ap50", score.bev_ap50}, {"bev_ap70", score.bev_ap70}};
  }

 private:
  const DetectionSetup& setup_;
  std::unique_ptr<Detector> detector_;
  std::vector<std::vector<Box>> truth_, found_;
};

class DetectionTask : public Task {
 public:
  DetectionTask(std::string key, std::size_t every, DetectionSetup setup)
      : Task("detection", std::move(key), every,
             setup.weights.empty() ? "the detector without weights" : "PointPillars"),
        setup_(std::move(setup)) {}

  Result<std::unique_ptr<TaskRun>> begin() const override {
    auto detector = setup_.detector();
    if (!detector) return tl::unexpected(std::move(detector.error()));
    return std::make_unique<DetectionRun>(setup_, std::move(*detector));
  }

 private:
  DetectionSetup setup_;
};

void add(const Labels& labels, ContentHash& hash) {
  for (const Box& box : labels.boxes) {
    const std::array<double, 8> numbers{
        box.centre.x(), box.centre.y(), box.centre.z(), box.length,
        box.width,      box.height,     box.yaw,        static_cast<double>(box.points)};
    hash.add(box.label).add(std::as_bytes(std::span(numbers)));
  }
  hash.add(labels.boxes.size());
}

/// Empty where a drive has none.
fs::path truth_folder(const fs::path& drive) {
  for (const char* folder : kFolders) {
    std::error_code error;
    if (fs::is_directory(drive / folder, error)) return drive / folder;
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<const Task>> make_detection_task(const DriveFiles& drive,
                                                        const TaskOptions& options) {
  const fs::path folder = truth_folder(drive.folder);
  if (folder.empty()) {
    return fail(ErrorCode::not_found,
                drive.folder.string() +
                    ": has no true boxes to score against; put a file of them for each sweep into "
                    "boxes/, as `sweepcast simulate` does, or into label_2/, as KITTI does");
  }
  DetectionSetup setup{std::vector<Labels>(drive.sweeps.size()), options.weights};
  const std::size_t every = options.full ? 1 : kDetectionEvery;
  ContentHash hash;
  for (std::size_t i = 0; i < setup.truth.size(); i += every) {
    auto labels = read_labels(folder, drive.sweeps[i].stem().string());
    if (!labels) return tl::unexpected(std::move(labels.error()));
    add(*labels, hash);
    setup.truth[i] = std::move(*labels);
  }
  std::string key = "boxes " + hash.hex() + ", every " + std::to_string(every);
  if (const auto detector = setup.detector(); !detector) {
    if (detector.error().code != ErrorCode::unsupported) return tl::unexpected(detector.error());
    setup.weights.clear();  // a build without libtorch
  }
  if (setup.weights.empty()) {
    key += ", clusters";
  } else {
    const auto weights = hash_file(setup.weights);
    if (!weights) return tl::unexpected(weights.error());
    key += ", pillars " + *weights;
  }
  return std::make_unique<DetectionTask>(std::move(key), every, std::move(setup));
}

}  // namespace sweepcast::lab
