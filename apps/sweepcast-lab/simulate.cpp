// `sweepcast simulate`: a ray-cast drive through a procedural town.
#include "lab/simulate/simulate.hpp"

#include <fmt/core.h>

#include <chrono>
#include <cstddef>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "common/progress.hpp"
#include "common/validators.hpp"
#include "lab/simulate/export.hpp"
#include "sweepcast-lab/commands.hpp"

namespace sweepcast::app {

namespace {

struct SimulateCommand {
  lab::SimulateOptions drive;
  lab::ExportOptions out;
  std::string folder;
  bool still = false;
  bool json = false;
};

void print(const SimulateCommand& options, const lab::ExportSummary& summary, double seconds) {
  const double mean = static_cast<double>(summary.points) / summary.sweeps;
  if (options.json) {
    const nlohmann::ordered_json report{{"folder", options.folder},
                                        {"sensor", options.drive.sensor},
                                        {"seed", options.drive.seed},
                                        {"sweeps", summary.sweeps},
                                        {"points_mean", mean},
                                        {"boxes", summary.boxes},
                                        {"triangles", summary.triangles},
                                        {"seconds", seconds}};
    fmt::print("{}\n", report.dump(2));
    return;
  }
  fmt::print("{}: {} sweeps of {}, {:.0f} points each, {} boxes, {} triangles, in {:.1f} s\n",
             options.folder, summary.sweeps, options.drive.sensor, mean, summary.boxes,
             summary.triangles, seconds);
}

Status simulate(SimulateCommand& options) {
  const auto begin = std::chrono::steady_clock::now();
  options.drive.moving = !options.still;
  const auto drive = lab::Drive::create(options.drive);
  if (!drive) return tl::unexpected(drive.error());
  Progress progress("simulating", static_cast<std::size_t>(options.drive.sweeps));
  const auto summary =
      lab::write_drive(*drive, options.folder, options.out, [&] { progress.step(); });
  if (!summary) return tl::unexpected(summary.error());
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
  print(options, *summary, spent.count());
  return {};
}

}  // namespace

void add_simulate(CLI::App& app, Command& command) {
  const auto options = std::make_shared<SimulateCommand>();
  CLI::App* sub = app.add_subcommand("simulate", "Make a drive: sweeps, poses, boxes and surfaces");
  sub->footer(
      "Writes DIR/sweeps/NNNNNN.pcd, boxes/NNNNNN.txt, poses.txt, mesh.ply and sensor.json.\n"
      "Same options, same bytes, on every machine.\n\n"
      "Example: 30 s of a 64-beam sensor, half the long loop\n"
      "  sweepcast simulate -o drive --sensor hdl64 --sweeps 300 --seed 7");
  lab::SimulateOptions& drive = options->drive;
  sub->add_option("-o,--output", options->folder, "Folder to make")->type_name("DIR")->required();
  sub->add_option("--sensor", drive.sensor, "hdl64, vlp16 or os1-128")
      ->check(CLI::IsMember({"hdl64", "vlp16", "os1-128"}))
      ->capture_default_str();
  sub->add_option("--sweeps", drive.sweeps, "How many, 10 a second and a metre apart")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  sub->add_option("--seed", drive.seed, "Decides town, traffic and noise")
      ->check(whole_number())
      ->capture_default_str();
  sub->add_option("--blocks", drive.blocks, "Drive round 1 block (about 290 m) or 3 (about 600 m)")
      ->check(CLI::IsMember({1, 3}))
      ->capture_default_str();
  sub->add_flag("--static", options->still, "Leave out what moves");
  sub->add_option("--noise", drive.noise, "Factor on the sensor's range noise; 0: exact ranges")
      ->check(number_between(0.0, 100.0))
      ->capture_default_str();
  sub->add_flag("--kitti", options->out.kitti, "Write .bin (x, y, z, intensity), not .pcd");
  sub->add_flag("--force", options->out.force, "Replace the drive in DIR");
  sub->add_option("--threads", options->out.threads, "Sweeps made at a time; 0: one a core")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  sub->add_flag("--json", options->json, "Print a summary as JSON");
  sub->callback([options, &command] { command = [options] { return simulate(*options); }; });
}

}  // namespace sweepcast::app
