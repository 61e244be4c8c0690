// `sweepcast detect`: boxes about the cars in sweeps, and how well they were found.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "common/cpu_time.hpp"
#include "common/inputs.hpp"
#include "common/progress.hpp"
#include "common/validators.hpp"
#include "io/file.hpp"
#include "lab/detect/average_precision.hpp"
#include "lab/detect/labels.hpp"
#include "sweepcast-lab/commands.hpp"
#include "sweepcast-lab/detectors.hpp"
#include "sweepcast/cloud_file.hpp"

namespace sweepcast::app {

namespace {

using BoxLists = std::vector<std::vector<lab::Box>>;

struct DetectCommand {
  std::vector<std::string> inputs;
  std::string output;
  std::string truth;
  std::string detector = "pillars";
  std::string weights;
  lab::ScoreOptions score;
  bool json = false;
};

struct Detections {
  BoxLists found;
  BoxLists truth;  ///< as many, or none
  double ms_per_sweep = 0.0;

  [[nodiscard]] std::size_t boxes() const {
    std::size_t count = 0;
    for (const auto& sweep : found) count += sweep.size();
    return count;
  }
};

/// The true boxes of a sweep; what lies where no label would be is taken out of those found.
Result<std::vector<lab::Box>> truth_of(const std::filesystem::path& sweep, const PointCloud& cloud,
                                       const DetectCommand& options, std::vector<lab::Box>& found) {
  auto labels = lab::read_labels(options.truth, sweep.stem().string());
  if (!labels) return tl::unexpected(labels.error());
  auto& boxes = labels->boxes;
  const auto counted = [](const lab::Box& box) { return box.points >= 0; };
  if (!std::all_of(boxes.begin(), boxes.end(), counted)) {
    lab::count_points(cloud, boxes);
  }
  if (labels->is_labelled) {
    std::erase_if(found, [&](const lab::Box& box) { return !labels->is_labelled(box.centre); });
  }
  return std::move(boxes);
}

Result<Detections> detect_all(const std::vector<std::filesystem::path>& sweeps,
                              lab::Detector& detector, const DetectCommand& options) {
  Detections detections;
  double spent_ms = 0.0;
  Progress progress("detecting", sweeps.size());
  PointCloud cloud;
  for (const auto& sweep : sweeps) {
    if (Status read = read_cloud(sweep, cloud); !read) return tl::unexpected(read.error());
    const double begin = cpu_time_ms();
    auto found = detector.detect(cloud);
    spent_ms += cpu_time_ms() - begin;
    if (!found) return tl::unexpected(found.error());
    const auto file =
        std::filesystem::path(options.output) / sweep.filename().replace_extension(".txt");
    if (Status written = lab::write_boxes(file, *found); !written) {
      return tl::unexpected(written.error());
    }
    if (!options.truth.empty()) {
      auto truth = truth_of(sweep, cloud, options, *found);
      if (!truth) return tl::unexpected(truth.error());
      detections.truth.push_back(std::move(*truth));
    }
    detections.found.push_back(std::move(*found));
    progress.step();
  }
  detections.ms_per_sweep = spent_ms / static_cast<double>(sweeps.size());
  return detections;
}

void print(const DetectCommand& options, const Detections& detections) {
  std::optional<lab::DetectionScore> score;
  if (!options.truth.empty()) {
    score = lab::detection_score(detections.truth, detections.found, options.score);
  }
  if (!options.json) {
    fmt::print("{}: {} boxes in {} sweeps, {:.0f} ms of CPU time each\n", options.output,
               detections.boxes(), detections.found.size(), detections.ms_per_sweep);
    if (!score) return;
    fmt::print(
        "average precision, {} points of recall, {} with at least {} points within {} m:\n"
        "  BEV {:.1f} at IoU 0.5, {:.1f} at 0.7; 3-D {:.1f} at 0.5, {:.1f} at 0.7\n",
        options.score.recall_points, options.score.label, options.score.min_points,
        options.score.max_range_m, score->bev_ap50, score->bev_ap70, score->ap50_3d,
        score->ap70_3d);
    return;
  }
  nlohmann::ordered_json report{{"output", options.output},
                                {"detector", options.detector},
                                {"sweeps", detections.found.size()},
                                {"boxes", detections.boxes()},
                                {"ms_per_sweep", detections.ms_per_sweep}};
  if (score) {
    report["recall_points"] = options.score.recall_points;
    report["bev_ap50"] = score->bev_ap50;
    report["bev_ap70"] = score->bev_ap70;
    report["ap50_3d"] = score->ap50_3d;
    report["ap70_3d"] = score->ap70_3d;
  }
  print_json(report);
}

Status detect(const DetectCommand& options) {
  const auto sweeps = collect_clouds(options.inputs);
  if (!sweeps) return tl::unexpected(sweeps.error());
  std::error_code error;
  if (!options.truth.empty() && !std::filesystem::is_directory(options.truth, error)) {
    return fail(ErrorCode::not_found,
                options.truth + ": is no folder; give that of the drive's true boxes");
  }
  if (Status checked = check_output(options.output, {options.truth}); !checked) return checked;
  const auto detector = make_detector(options.detector, options.weights);
  if (!detector) return tl::unexpected(detector.error());
  std::filesystem::create_directories(options.output, error);
  if (error) return io_failure(options.output, "cannot be made", error.value());
  const auto detections = detect_all(*sweeps, **detector, options);
  if (!detections) return tl::unexpected(detections.error());
  print(options, *detections);
  return {};
}

void add_score_options(CLI::App& sub, DetectCommand& options) {
  sub.add_option("--truth", options.truth,
                 "True boxes, a file a sweep of its base name: those of `simulate`, KITTI's "
                 "label_2 (with ../calib), or PandaSet's .csv (with poses.txt)")
      ->type_name("DIR");
  sub.add_option("--recall", options.score.recall_points, "Points of recall: 40 or 11, as KITTI")
      ->check(CLI::IsMember({40, 11}))
      ->capture_default_str();
  sub.add_option("--min-points", options.score.min_points,
                 "True boxes with fewer points do not count")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  sub.add_option("--max-range", options.score.max_range_m, "Nor do farther boxes, metres")
      ->check(number_between(1.0, 1000.0))
      ->capture_default_str();
}

}  // namespace

void add_detect(CLI::App& app, Command& command) {
  const auto options = std::make_shared<DetectCommand>();
  CLI::App* sub = app.add_subcommand("detect", "Find cars in sweeps, and say how well");
  sub->footer(
      "Writes DIR/NAME.txt for each sweep, a line a box: label x y z length width height yaw "
      "points score.\n\n"
      "Example: how well cars of a simulated street are found\n"
      "  sweepcast simulate -o drive --sweeps 20\n"
      "  sweepcast detect drive -o found --truth drive/boxes");
  sub->add_option("INPUT", options->inputs, "Sweeps: files or folders")->required();
  sub->add_option("-o,--output", options->output, "Folder for the boxes")
      ->type_name("DIR")
      ->required();
  sub->add_option("--detector", options->detector,
                  "pillars: PointPillars; clusters: without weights")
      ->check(CLI::IsMember({"pillars", "clusters"}))
      ->capture_default_str();
  sub->add_option("--weights", options->weights, "Of the network [those shipped]")
      ->type_name("FILE");
  add_score_options(*sub, *options);
  sub->add_flag("--json", options->json, "Print the figures as JSON");
  sub->callback([options, &command] { command = [options] { return detect(*options); }; });
}

}  // namespace sweepcast::app
