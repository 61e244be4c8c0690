// `sweepcast odometry`: where the sensor was at each sweep.
#include "lab/odometry/odometry.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/cpu_time.hpp"
#include "common/inputs.hpp"
#include "common/progress.hpp"
#include "common/validators.hpp"
#include "lab/odometry/sweep_clock.hpp"
#include "lab/odometry/trajectory.hpp"
#include "sweepcast-lab/commands.hpp"
#include "sweepcast/cloud_file.hpp"

namespace sweepcast::app {

namespace {

struct OdometryCommand {
  std::vector<std::string> inputs;
  std::string output;
  std::string truth;
  std::string deskew = "auto";
  lab::OdometryOptions options;
  bool json = false;
};

/// Poses of the sweeps. With `deskew`, those with times are deskewed.
Result<std::vector<lab::RigidTransform>> run_odometry(
    const std::vector<std::filesystem::path>& sweeps, const OdometryCommand& options) {
  lab::Odometry odometry(options.options);
  Progress progress("odometry", sweeps.size());
  PointCloud cloud;
  std::vector<float> when;
  for (const auto& sweep : sweeps) {
    if (Status read = read_cloud(sweep, cloud); !read) return tl::unexpected(read.error());
    when.clear();
    if (options.deskew == "auto") {
      if (const auto clock = lab::SweepClock::learn(cloud)) clock->tell(cloud, when);
    }
    odometry.add(cloud, when);
    progress.step();
  }
  const std::size_t empty = odometry.empty_sweeps();
  if (empty == sweeps.size()) {
    return fail(ErrorCode::invalid_argument,
                fmt::format("{}: neither this sweep nor one after it has a point from {} to {} m "
                            "away; give others, or another --min-range and --max-range",
                            sweeps.front().string(), options.options.min_range_m,
                            options.options.max_range_m));
  }
  if (empty > 0) {
    print_note(
        fmt::format("{} sweeps have no point in range; motion goes on there as before", empty));
  }
  return odometry.poses();
}

nlohmann::ordered_json report_of(const lab::TrajectoryError& error) {
  nlohmann::ordered_json report{{"length_m", error.length_m}, {"stretches", error.stretches}};
  const bool is_long = error.stretches > 0;
  report["translation_error_percent"] =
      is_long ? nlohmann::ordered_json(error.translation_percent) : nullptr;
  report["rotation_error_deg_per_m"] =
      is_long ? nlohmann::ordered_json(error.rotation_deg_per_m) : nullptr;
  report["step_translation_m"] = error.step_translation_m;
  report["step_rotation_deg"] = error.step_rotation_deg;
  return report;
}

void print_text(const OdometryCommand& options, std::size_t sweeps, double ms_each,
                const std::optional<lab::TrajectoryError>& error) {
  fmt::print("{}: {} poses, {:.1f} ms of CPU time a sweep\n", options.output, sweeps, ms_each);
  if (!error) return;
  if (error->stretches > 0) {
    fmt::print(
        "translation error {:.3f} %, rotation error {:.5f} deg/m, over {} stretches of 100 "
        "to 800 m of a path of {:.0f} m\n",
        error->translation_percent, error->rotation_deg_per_m, error->stretches, error->length_m);
  } else {
    fmt::print("the path of {:.1f} m is too short for errors over 100 m and more\n",
               error->length_m);
  }
  fmt::print("from sweep to sweep, RMS: {:.4f} m, {:.4f} deg\n", error->step_translation_m,
             error->step_rotation_deg);
}

Status odometry(const OdometryCommand& options) {
  const auto sweeps = collect_clouds(options.inputs);
  if (!sweeps) return tl::unexpected(sweeps.error());
  auto reads = *sweeps;
  reads.emplace_back(options.truth);
  if (Status checked = check_output(options.output, reads); !checked) return checked;
  std::vector<lab::RigidTransform> truth;
  if (!options.truth.empty()) {
    auto read = lab::read_poses(options.truth);
    if (!read) return tl::unexpected(read.error());
    truth = std::move(*read);
    if (truth.size() < sweeps->size()) {
      return fail(ErrorCode::invalid_argument,
                  fmt::format("{}: {} poses for {} sweeps; give the poses of this drive",
                              options.truth, truth.size(), sweeps->size()));
    }
    truth.resize(sweeps->size());
  }
  const double begin = cpu_time_ms();
  const auto poses = run_odometry(*sweeps, options);
  if (!poses) return tl::unexpected(poses.error());
  const double spent_ms = cpu_time_ms() - begin;
  if (Status written = lab::write_poses(options.output, *poses); !written) return written;

  std::optional<lab::TrajectoryError> error;
  if (truth.size() > 1) {
    const auto compared = lab::trajectory_error(truth, *poses);
    if (!compared) return tl::unexpected(compared.error());
    error = *compared;
  }
  const double ms_each = spent_ms / static_cast<double>(sweeps->size());
  if (options.json) {
    nlohmann::ordered_json report{
        {"output", options.output}, {"sweeps", sweeps->size()}, {"ms_per_sweep", ms_each}};
    if (error) report.update(report_of(*error));
    print_json(report);
  } else {
    print_text(options, sweeps->size(), ms_each, error);
  }
  return {};
}

}  // namespace

void add_odometry(CLI::App& app, Command& command) {
  const auto options = std::make_shared<OdometryCommand>();
  CLI::App* sub = app.add_subcommand("odometry", "Find where the sensor was, from sweeps alone");
  sub->footer(
      "Writes a line a sweep, as KITTI does: a 3x4 matrix row by row, sensor to first sensor, at\n"
      "the sweep's last firing.\n\n"
      "Example: how well it finds the path of a simulated drive\n"
      "  sweepcast simulate -o drive --sweeps 300\n"
      "  sweepcast odometry drive -o poses.txt --truth drive/poses.txt");
  lab::OdometryOptions& odometry_options = options->options;
  sub->add_option("INPUT", options->inputs, "Sweeps in the order of time: files or folders")
      ->required();
  sub->add_option("-o,--output", options->output, "File of poses to write")
      ->type_name("FILE")
      ->required();
  sub->add_option("--truth", options->truth, "True poses of the same form, to compare with")
      ->type_name("FILE");
  sub->add_option("--deskew", options->deskew,
                  "auto: deskew sweeps whose points have times; off: they are deskewed already")
      ->check(CLI::IsMember({"auto", "off"}))
      ->capture_default_str();
  sub->add_option("--voxel", odometry_options.voxel_m, "Size of the map's cubes, metres")
      ->check(number_between(0.05, 10.0))
      ->capture_default_str();
  sub->add_option("--min-range", odometry_options.min_range_m, "Nearer points do not count, metres")
      ->check(number_between(0.0, 1000.0))
      ->capture_default_str();
  sub->add_option("--max-range", odometry_options.max_range_m,
                  "Farther points do not count, metres")
      ->check(number_between(1.0, 1000.0))
      ->capture_default_str();
  sub->add_flag("--json", options->json, "Print the figures as JSON");
  sub->callback([options, &command] { command = [options] { return odometry(*options); }; });
}

}  // namespace sweepcast::app
