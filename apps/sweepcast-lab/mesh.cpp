// `sweepcast mesh`: one surface of many sweeps, and how far it lies from another.
#include <fmt/core.h>

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
#include "lab/mesh/mesh_error.hpp"
#include "lab/mesh/seen_space.hpp"
#include "lab/mesh/tsdf.hpp"
#include "lab/odometry/sweep_clock.hpp"
#include "lab/odometry/trajectory.hpp"
#include "sweepcast-lab/commands.hpp"
#include "sweepcast/cloud_file.hpp"

namespace sweepcast::app {

namespace {

using Files = std::vector<std::filesystem::path>;

struct MeshCommand {
  std::vector<std::string> inputs;
  std::vector<std::string> originals;
  std::string poses;
  std::string output;
  std::string truth;
  std::string deskew = "auto";
  lab::TsdfOptions volume;
  lab::RangeLimits limits;
  int min_weight = 1;
  bool json = false;
};

/// What sweeps have seen.
struct Fusion {
  lab::TriangleMesh mesh;
  lab::SeenSpace seen;
  double ms_per_sweep = 0.0;
  std::size_t memory_bytes = 0;
};

/// When the points of a sweep were measured, to deskew by; empty where they are deskewed already.
/// A decoded sweep has no times of its own, so `timed` may be the sweep that it was coded from.
Status tell_times(const std::filesystem::path& timed, const PointCloud& cloud,
                  std::vector<float>& when) {
  std::optional<lab::SweepClock> clock = lab::SweepClock::learn(cloud);
  if (!clock && !timed.empty()) {
    PointCloud original;
    if (Status read = read_cloud(timed, original); !read) return read;
    clock = lab::SweepClock::learn(original);
  }
  when.clear();
  if (clock) clock->tell(cloud, when);
  return {};
}

/// Fuses sweeps into a surface; `timed` are as many, or none.
Result<Fusion> fuse(const Files& sweeps, const Files& timed,
                    const std::vector<lab::RigidTransform>& poses, const MeshCommand& options) {
  auto volume = lab::TsdfVolume::create(options.volume);
  if (!volume) return tl::unexpected(volume.error());
  Fusion fusion;
  const double begin = cpu_time_ms();
  Progress progress("meshing", sweeps.size());
  PointCloud cloud;
  std::vector<float> when;
  std::vector<lab::Ray> rays;
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    if (Status read = read_cloud(sweeps[i], cloud); !read) return tl::unexpected(read.error());
    if (options.deskew == "auto") {
      const auto told = tell_times(timed.empty() ? "" : timed[i], cloud, when);
      if (!told) return tl::unexpected(told.error());
    }
    lab::rays_of(cloud, when, poses[i], lab::motion_during(poses, i), options.limits, rays);
    volume->add(rays);
    fusion.seen.add(rays);
    progress.step();
  }
  fusion.mesh = volume->surface(options.min_weight);
  fusion.ms_per_sweep = (cpu_time_ms() - begin) / static_cast<double>(sweeps.size());
  fusion.memory_bytes = volume->memory_bytes();
  return fusion;
}

nlohmann::ordered_json report_of(const lab::MeshError& error) {
  nlohmann::ordered_json scores = nlohmann::ordered_json::array();
  for (const lab::MeshScore& score : error.scores) {
    scores.push_back({{"threshold_m", score.threshold_m},
                      {"f_score", score.f_score},
                      {"precision", score.precision},
                      {"recall", score.recall}});
  }
  return {{"accuracy_m", error.accuracy_m},
          {"completeness_m", error.completeness_m},
          {"scores", scores}};
}

void print_text(const char* against, const lab::MeshError& error) {
  fmt::print("against {}: accuracy {:.4f} m, completeness {:.4f} m\n", against, error.accuracy_m,
             error.completeness_m);
  for (const lab::MeshScore& score : error.scores) {
    fmt::print("  within {:.0f} cm: F-score {:.1f} (precision {:.1f}, recall {:.1f})\n",
               100.0 * score.threshold_m, score.f_score, score.precision, score.recall);
  }
}

/// The surfaces to compare with, as far as they were asked for.
struct Comparison {
  std::optional<lab::MeshError> truth;
  std::optional<lab::MeshError> originals;
};

Result<Comparison> compare(const MeshCommand& options, const Fusion& fusion,
                           const std::optional<Fusion>& originals) {
  Comparison comparison;
  if (!options.truth.empty()) {
    const auto truth = lab::read_mesh(options.truth);
    if (!truth) return tl::unexpected(truth.error());
    const lab::SeenSpace& seen = originals ? originals->seen : fusion.seen;
    const auto error =
        lab::mesh_error(fusion.mesh, *truth, {}, [&](const auto& p) { return seen.is_seen(p); });
    if (!error) return fail(error.error().code, options.truth + ": " + error.error().message);
    comparison.truth = *error;
  }
  if (originals) {
    const auto error = lab::mesh_error(fusion.mesh, originals->mesh);
    if (!error) return fail(error.error().code, options.output + ": " + error.error().message);
    comparison.originals = *error;
  }
  return comparison;
}

void print(const MeshCommand& options, std::size_t sweeps, const Fusion& fusion,
           const Comparison& comparison) {
  if (options.json) {
    nlohmann::ordered_json report{{"output", options.output},
                                  {"sweeps", sweeps},
                                  {"vertices", fusion.mesh.vertices.size()},
                                  {"triangles", fusion.mesh.triangles.size()},
                                  {"ms_per_sweep", fusion.ms_per_sweep},
                                  {"volume_bytes", fusion.memory_bytes}};
    if (comparison.truth) report["truth"] = report_of(*comparison.truth);
    if (comparison.originals) report["originals"] = report_of(*comparison.originals);
    print_json(report);
    return;
  }
  fmt::print("{}: {} triangles from {} sweeps, {:.0f} ms each\n", options.output,
             fusion.mesh.triangles.size(), sweeps, fusion.ms_per_sweep);
  if (comparison.truth) print_text("the true mesh, as far as it was seen", *comparison.truth);
  if (comparison.originals) print_text("the originals' mesh", *comparison.originals);
}

Status mesh(const MeshCommand& options) {
  const auto sweeps = collect_clouds(options.inputs);
  if (!sweeps) return tl::unexpected(sweeps.error());
  Files originals;
  if (!options.originals.empty()) {
    auto found = collect_clouds(options.originals);
    if (!found) return tl::unexpected(found.error());
    originals = std::move(*found);
    if (originals.size() != sweeps->size()) {
      return fail(ErrorCode::invalid_argument,
                  fmt::format("--originals: {} sweeps for {}; give those that were coded",
                              originals.size(), sweeps->size()));
    }
  }
  Files reads = *sweeps;
  reads.insert(reads.end(), originals.begin(), originals.end());
  reads.insert(reads.end(), {options.poses, options.truth});
  if (Status checked = check_output(options.output, reads); !checked) return checked;
  const auto poses = lab::read_poses(options.poses);
  if (!poses) return tl::unexpected(poses.error());
  if (poses->size() < sweeps->size()) {
    return fail(ErrorCode::invalid_argument,
                fmt::format("{}: {} poses for {} sweeps; give the poses of this drive",
                            options.poses, poses->size(), sweeps->size()));
  }
  const auto fusion = fuse(*sweeps, originals, *poses, options);
  if (!fusion) return tl::unexpected(fusion.error());
  if (Status written = lab::write_mesh(options.output, fusion->mesh); !written) return written;
  std::optional<Fusion> original;
  if (!originals.empty()) {
    auto fused = fuse(originals, {}, *poses, options);
    if (!fused) return tl::unexpected(fused.error());
    original = std::move(*fused);
  }
  const auto comparison = compare(options, *fusion, original);
  if (!comparison) return tl::unexpected(comparison.error());
  print(options, sweeps->size(), *fusion, *comparison);
  return {};
}

void add_fusion_options(CLI::App& sub, MeshCommand& options) {
  sub.add_option("--voxel", options.volume.voxel_m, "Size of the grid's cubes, metres")
      ->check(number_between(0.005, 10.0))
      ->capture_default_str();
  sub.add_option("--truncation", options.volume.truncation_voxels,
                 "How far about a point the surface's distance is kept, voxels")
      ->check(number_between(1.0, 20.0))
      ->capture_default_str();
  sub.add_flag("--carve", options.volume.carve, "Remove what rays pass through: what has moved");
  sub.add_option("--min-weight", options.min_weight, "Rays that a cube of the surface must have")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  sub.add_option("--min-range", options.limits.min_m, "Nearer points do not count, metres")
      ->check(number_between(0.0, 1000.0))
      ->capture_default_str();
  sub.add_option("--max-range", options.limits.max_m, "Farther points do not count, metres")
      ->check(number_between(1.0, 1000.0))
      ->capture_default_str();
  sub.add_option("--deskew", options.deskew,
                 "auto: deskew sweeps whose points have times; off: they are deskewed already")
      ->check(CLI::IsMember({"auto", "off"}))
      ->capture_default_str();
}

}  // namespace

void add_mesh(CLI::App& app, Command& command) {
  const auto options = std::make_shared<MeshCommand>();
  CLI::App* sub = app.add_subcommand("mesh", "Make one surface of many sweeps, and compare it");
  sub->footer(
      "Poses are as `odometry` writes them: a line a sweep, at the last firing.\n\n"
      "Example: how well a simulated street comes out\n"
      "  sweepcast simulate -o drive --static --sweeps 100\n"
      "  sweepcast mesh drive --poses drive/poses.txt -o mesh.ply --truth drive/mesh.ply");
  sub->add_option("INPUT", options->inputs, "Sweeps in the order of time: files or folders")
      ->required();
  sub->add_option("--poses", options->poses, "Where the sensor was")->type_name("FILE")->required();
  sub->add_option("-o,--output", options->output, "PLY to write")->type_name("FILE")->required();
  sub->add_option("--truth", options->truth, "True mesh, to compare with as far as it was seen")
      ->type_name("FILE");
  sub->add_option("--originals", options->originals,
                  "Sweeps that INPUT was coded from: compare with their mesh, count as seen what "
                  "they saw, and take their times");
  add_fusion_options(*sub, *options);
  sub->add_flag("--json", options->json, "Print the figures as JSON");
  sub->callback([options, &command] { command = [options] { return mesh(*options); }; });
}

}  // namespace sweepcast::app
