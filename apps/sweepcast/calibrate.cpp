// `sweepcast calibrate`: the sensor's own geometry, found in its sweeps.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/inputs.hpp"
#include "common/progress.hpp"
#include "common/sensor_file.hpp"
#include "core/trig.hpp"
#include "io/file.hpp"
#include "lab/gnuplot.hpp"
#include "sensor/beam_grid.hpp"
#include "sweepcast/cloud_file.hpp"
#include "sweepcast/commands.hpp"

namespace sweepcast::app {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct CalibrateOptions {
  std::vector<std::string> inputs;
  std::string output;
  std::string plot;
  std::size_t sweeps = 5;
  int ticks = 0;
  bool ignore_ring = false;
  bool json = false;
};

/// What the beam grid makes of a sweep.
struct GridFigures {
  std::size_t points = 0, cells = 0, collisions = 0, strays = 0;
  int firings = 0;
  std::vector<double> errors;  // metres, of the points in cells, rising
};

/// At most `count` of the files, evenly spread.
std::vector<fs::path> spread(const std::vector<fs::path>& files, std::size_t count) {
  std::vector<fs::path> some;
  const std::size_t taken = std::min(count, files.size());
  for (std::size_t i = 0; i < taken; ++i) some.push_back(files[i * files.size() / taken]);
  return some;
}

GridFigures grid_figures(const PointCloud& cloud, const SensorEstimate& estimate) {
  BeamGridOptions options;
  if (!estimate.motions.empty()) options.motion = estimate.motions.front();
  BeamImage image;
  BeamProjector(estimate.model).project(cloud, options, image);
  PointCloud back;
  BeamUnprojector(estimate.model).unproject(image, back);
  GridFigures figures;
  figures.points = cloud.size();
  figures.cells = back.size();
  figures.firings = image.cols;
  for (const ExtraPoint& extra : image.extras) {
    ++(extra.reason == ExtraReason::collision ? figures.collisions : figures.strays);
  }
  std::size_t at = 0;
  for (const std::uint32_t i : image.point) {
    if (i == kNoPoint) continue;
    const double dx = static_cast<double>(back.x[at]) - cloud.x[i];
    const double dy = static_cast<double>(back.y[at]) - cloud.y[i];
    const double dz = static_cast<double>(back.z[at]) - cloud.z[i];
    figures.errors.push_back(std::sqrt(dx * dx + dy * dy + dz * dz));
    ++at;
  }
  std::sort(figures.errors.begin(), figures.errors.end());
  return figures;
}

double quantile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0.0;
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

Json residuals_json(const SensorResiduals& r) {
  return {{"points", r.points},
          {"height_median_m", r.height_median_m},
          {"height_p95_m", r.height_p95_m},
          {"height_p99_m", r.height_p99_m},
          {"azimuth_median_deg", r.azimuth_median_deg},
          {"azimuth_p95_deg", r.azimuth_p95_deg},
          {"azimuth_p99_deg", r.azimuth_p99_deg},
          {"share_within_5mm", r.share_5mm},
          {"share_within_2cm", r.share_2cm},
          {"share_within_5cm", r.share_5cm},
          {"blur", r.blur}};
}

Json motions_json(const std::vector<Motion>& motions, const std::vector<fs::path>& files) {
  Json list = Json::array();
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const Motion& m = motions[i];
    Json entry{{"sweep", files[i].filename().string()}};
    for (const std::int32_t v : m.translation) {
      entry["translation_m"].push_back(static_cast<double>(v) / kLengthUnits);
    }
    for (const std::int32_t v : m.rotation) {
      entry["rotation_deg"].push_back(static_cast<double>(v) / kAngleUnits);
    }
    entry["nod"] = static_cast<double>(m.nod) / kTangentUnits;
    entry["mount"] = mount_json(m.mount);
    list.push_back(std::move(entry));
  }
  return list;
}

Json report_json(const SensorEstimate& estimate, const std::vector<fs::path>& files,
                 const GridFigures& grid) {
  Json json = sensor_json(estimate.model);
  json["residuals"] = residuals_json(estimate.residuals);
  json["grid"] = {{"points", grid.points},
                  {"cells", grid.cells},
                  {"firings", grid.firings},
                  {"collisions", grid.collisions},
                  {"strays", grid.strays},
                  {"error_median_m", quantile(grid.errors, 0.5)},
                  {"error_p99_m", quantile(grid.errors, 0.99)},
                  {"error_max_m", quantile(grid.errors, 1.0)}};
  if (!estimate.motions.empty()) json["motions"] = motions_json(estimate.motions, files);
  return json;
}

/// The six numbers of a Motion or a Mount.
template <class Pose>
std::string pose_text(const Pose& pose) {
  const auto metres = [&](std::size_t axis) {
    return static_cast<double>(pose.translation[axis]) / kLengthUnits;
  };
  const auto degrees = [&](std::size_t axis) {
    return static_cast<double>(pose.rotation[axis]) / kAngleUnits;
  };
  return fmt::format("{:.3f} {:.3f} {:.3f} m and {:.3f} {:.3f} {:.3f} degrees", metres(0),
                     metres(1), metres(2), degrees(0), degrees(1), degrees(2));
}

void report_text(const SensorEstimate& estimate, const GridFigures& grid) {
  const SensorModel& model = estimate.model;
  const SensorResiduals& r = estimate.residuals;
  const auto degrees = [](const Beam& beam) {
    return arc_tangent(static_cast<double>(beam.tan_elevation) / kTangentUnits, 1.0) / kDegree;
  };
  fmt::print("beams      {}, from {:.2f} to {:.2f} degrees\n", model.beams.size(),
             degrees(model.beams.front()), degrees(model.beams.back()));
  fmt::print("ticks      {} a turn\n", model.ticks_per_turn);
  fmt::print("height     off by {:.2f} mm (median), {:.2f} mm (p95), {:.2f} mm (p99)\n",
             1e3 * r.height_median_m, 1e3 * r.height_p95_m, 1e3 * r.height_p99_m);
  fmt::print("azimuth    off by {:.4f} deg (median), {:.4f} deg (p95), {:.4f} deg (p99)\n",
             r.azimuth_median_deg, r.azimuth_p95_deg, r.azimuth_p99_deg);
  fmt::print(
      "explained  {:.3f} % of {} points within 5 mm, {:.3f} % within 2 cm, {:.3f} % within 5 cm\n",
      100 * r.share_5mm, r.points, 100 * r.share_2cm, 100 * r.share_5cm);
  if (!estimate.motions.empty()) {
    fmt::print("deskewed   by {} a turn (first sweep)\n", pose_text(estimate.motions.front()));
  }
  if (model.mount != Mount{}) fmt::print("mount      {} from the cloud\n", pose_text(model.mount));
  fmt::print(
      "grid       {} of {} points in {} firings ({} collisions, {} strays), off by at most {:.2f} "
      "mm (p99)\n",
      grid.cells, grid.points, grid.firings, grid.collisions, grid.strays,
      1e3 * quantile(grid.errors, 0.99));
}

/// Three panels: where the beams stand, where they look, and how far points are from their cells.
std::string plot_script(const SensorModel& model, const GridFigures& grid, const fs::path& output) {
  std::string beams;
  for (const Beam& beam : model.beams) {
    const double tangent = static_cast<double>(beam.tan_elevation) / kTangentUnits;
    const double lag = 360.0 * beam.lag / model.ticks_per_turn;
    beams += fmt::format("{} {} {} {}\n", arc_tangent(tangent, 1.0) / kDegree,
                         1e3 * beam.height / kLengthUnits, 1e3 * beam.lateral_offset / kLengthUnits,
                         lag + static_cast<double>(beam.azimuth_offset) / kAngleUnits);
  }
  std::string errors;
  for (int i = 0; i <= 1000; ++i) {
    errors += fmt::format("{} {}\n", 1e3 * quantile(grid.errors, i / 1000.0), i / 10.0);
  }
  return lab::plot_output(output, 1500, 500) + "$beams << END\n" + beams + "END\n$errors << END\n" +
         errors + R"gnuplot(END
set multiplot layout 1,3
set grid linecolor rgb "#dddddd" linetype 1
set border 3 linecolor rgb "#555555"
set tics nomirror out scale 0.6
set xlabel "elevation, degrees"
set ylabel "mm"
set title "Origin of the beams"
plot $beams using 1:2 with points pointtype 7 pointsize 0.7 linecolor rgb "#0b62a4" title "height", \
     $beams using 1:3 with points pointtype 5 pointsize 0.7 linecolor rgb "#c8501e" title "to the left"
set ylabel "degrees"
set title "Azimuth within a firing"
plot $beams using 1:4 with points pointtype 7 pointsize 0.7 linecolor rgb "#0b62a4" notitle
set xlabel "distance of a point from its cell, mm"
set ylabel "points, %"
set yrange [0:101]
set title "What the model leaves"
plot $errors using 1:2 with lines linewidth 2 linecolor rgb "#0b62a4" notitle
unset multiplot
)gnuplot";
}

Status write_json(const fs::path& path, const Json& json) {
  const std::string text = json.dump(1) + "\n";
  return write_file(path, std::as_bytes(std::span(text)));
}

Status calibrate(const CalibrateOptions& options) {
  if (!options.plot.empty()) {
    if (Status possible = lab::check_plot(options.plot); !possible) return possible;
  }
  const auto files = collect_clouds(options.inputs);
  if (!files) return tl::unexpected(files.error());
  const std::vector<fs::path> chosen = spread(*files, options.sweeps);
  std::vector<PointCloud> clouds(chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (Status read = read_cloud(chosen[i], clouds[i]); !read) return read;
  }
  const std::vector<CloudView> views(clouds.begin(), clouds.end());
  SensorEstimateOptions how;
  how.ticks_per_turn = options.ticks;
  how.use_ring = !options.ignore_ring;
  const auto estimate = estimate_sensor_model(views, how);
  if (!estimate) {
    return fail(estimate.error().code, options.inputs.front() + ": " + estimate.error().message);
  }
  const GridFigures grid = grid_figures(clouds.front(), *estimate);
  const Json json = report_json(*estimate, chosen, grid);
  if (!options.output.empty()) {
    if (Status wrote = write_json(options.output, json); !wrote) return wrote;
  }
  if (!options.plot.empty()) {
    const std::string script = plot_script(estimate->model, grid, options.plot);
    if (Status drawn = lab::draw_plot(script, options.plot); !drawn) return drawn;
  }
  if (options.json) {
    print_json(json);
  } else {
    report_text(*estimate, grid);
  }
  return {};
}

}  // namespace

void add_calibrate(CLI::App& app, Command& command) {
  const auto options = std::make_shared<CalibrateOptions>();
  CLI::App* sub = app.add_subcommand("calibrate", "Find a spinning LiDAR's geometry in its sweeps");
  sub->footer(
      "Needs neither rings nor an order of the points. Of many sweeps, a few are enough.\n\n"
      "Example: sweepcast calibrate drive/sweeps -o sensor.json --plot sensor.png");
  sub->add_option("INPUT", options->inputs, "Clouds (.bin, .pcd, .ply), or folders of them")
      ->required();
  sub->add_option("-o,--output", options->output, "Sensor model to write")->type_name("FILE.json");
  sub->add_option("--plot", options->plot, "Draw the model and what it leaves")
      ->type_name("FILE.png");
  sub->add_option("--sweeps", options->sweeps, "How many sweeps to look at, evenly spread")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sub->add_option("--ticks", options->ticks, "Ticks of the encoder in a turn; 0: find out")
      ->check(CLI::Range(0, kMaxTicks))
      ->capture_default_str();
  sub->add_flag("--ignore-ring", options->ignore_ring, "Find the beams even where there are rings");
  sub->add_flag("--json", options->json, "Print the model as JSON");
  sub->callback([options, &command] { command = [options] { return calibrate(*options); }; });
}

}  // namespace sweepcast::app
