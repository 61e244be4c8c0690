// `sweepcast compare`: what a decoded cloud lost against the original.
#include <fmt/core.h>

#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/distortion_report.hpp"
#include "common/inputs.hpp"
#include "common/progress.hpp"
#include "lab/distortion.hpp"
#include "sweepcast/cloud_file.hpp"
#include "sweepcast/commands.hpp"

namespace sweepcast::app {

namespace {

namespace fs = std::filesystem;
using lab::Distortion;

struct CompareOptions {
  std::string original;
  std::string decoded;
  bool json = false;
};

/// Two files of the same sweep.
struct Pair {
  fs::path original;
  fs::path decoded;
};

struct NamedDistortion {
  std::string name;
  Distortion distortion;
};

Result<Distortion> compare_pair(const Pair& pair) {
  PointCloud original;
  PointCloud decoded;
  if (Status read = read_cloud(pair.original, original); !read) {
    return tl::unexpected(read.error());
  }
  if (Status read = read_cloud(pair.decoded, decoded); !read) return tl::unexpected(read.error());
  return lab::compare(original, decoded);
}

/// A folder's clouds by base name.
Result<std::map<std::string, fs::path>> by_base_name(const std::string& folder) {
  const auto files = collect_clouds({folder});
  if (!files) return tl::unexpected(files.error());
  std::map<std::string, fs::path> result;
  for (const fs::path& file : *files) result.emplace(file.stem().string(), file);
  return result;
}

/// Takes what both folders have by the same base name; anything alone is an error that lists it.
Result<std::vector<Pair>> pair_up(const CompareOptions& options) {
  const auto originals = by_base_name(options.original);
  if (!originals) return tl::unexpected(originals.error());
  const auto decoded = by_base_name(options.decoded);
  if (!decoded) return tl::unexpected(decoded.error());
  std::vector<Pair> pairs;
  std::string alone;
  for (const auto& [name, file] : *originals) {
    const auto partner = decoded->find(name);
    if (partner != decoded->end()) {
      pairs.push_back({file, partner->second});
    } else {
      alone += "\n  " + file.string();
    }
  }
  for (const auto& [name, file] : *decoded) {
    if (originals->count(name) == 0) alone += "\n  " + file.string();
  }
  if (alone.empty()) return pairs;
  return fail(ErrorCode::invalid_argument,
              fmt::format("{}, {}: these files have no partner of the same base name in the other "
                          "folder; remove or add them:{}",
                          options.original, options.decoded, alone));
}

void report_json(const std::vector<NamedDistortion>& sweeps, const Distortion& mean) {
  nlohmann::ordered_json report{{"sweeps", nlohmann::ordered_json::array()},
                                {"mean", nlohmann::ordered_json::object()}};
  for (const NamedDistortion& sweep : sweeps) {
    nlohmann::ordered_json entry{{"name", sweep.name}};
    add_distortion(entry, sweep.distortion);
    report["sweeps"].push_back(std::move(entry));
  }
  add_distortion(report["mean"], mean);
  print_json(report);
}

/// "25 points, 1 of them left out"; sweeps may have fractions in the mean.
std::string points_text(double points, double left_out) {
  std::string text = fmt::format("{:.0f} points", points);
  if (left_out > 0) text += fmt::format(", {:g} of them left out", left_out);
  return text;
}

void report_text(const Distortion& d) {
  fmt::print("original   {}\n", points_text(d.points_original, d.left_out_original));
  fmt::print("decoded    {}\n\n", points_text(d.points_decoded, d.left_out_decoded));
  fmt::print("distance, m            mean       rms       max\n");
  fmt::print("original to decoded {:>9.4f} {:>9.4f} {:>9.4f}\n", d.mean_o2d, d.rms_o2d, d.max_o2d);
  fmt::print("decoded to original {:>9.4f} {:>9.4f} {:>9.4f}\n\n", d.mean_d2o, d.rms_d2o,
             d.max_d2o);
  fmt::print("PSNR, dB      D1 {:.2f}, D2 {:.2f} (peak {:.2f} m)\n", d.d1_psnr, d.d2_psnr,
             lab::kPeakM);
  fmt::print("F-score, %    {:.2f} at 2 cm, {:.2f} at 5 cm, {:.2f} at 10 cm, {:.2f} at 20 cm\n",
             d.f_score[0], d.f_score[1], d.f_score[2], d.f_score[3]);
  fmt::print("mean error    azimuth {:+.4f} deg, elevation {:+.4f} deg\n", d.mean_azimuth_error_deg,
             d.mean_elevation_error_deg);
}

void report_table(const std::vector<NamedDistortion>& sweeps, const Distortion& mean) {
  std::size_t width = 5;
  for (const NamedDistortion& sweep : sweeps) width = std::max(width, sweep.name.size());
  fmt::print(
      "{:{}}    points   decoded  mean o2d  mean d2o     D1 dB     D2 dB   F 2cm   F 5cm  "
      "F 10cm  F 20cm\n",
      "sweep", width);
  const auto line = [width](const std::string& name, const Distortion& d) {
    fmt::print(
        "{:{}} {:>9.0f} {:>9.0f} {:>9.4f} {:>9.4f} {:>9.2f} {:>9.2f} {:>7.2f} {:>7.2f} {:>7.2f} "
        "{:>7.2f}\n",
        name, width, d.points_original, d.points_decoded, d.mean_o2d, d.mean_d2o, d.d1_psnr,
        d.d2_psnr, d.f_score[0], d.f_score[1], d.f_score[2], d.f_score[3]);
  };
  for (const NamedDistortion& sweep : sweeps) line(sweep.name, sweep.distortion);
  line("mean", mean);
  fmt::print("\nmean over {} sweeps:\n", sweeps.size());
  report_text(mean);
}

Status compare_files(const CompareOptions& options) {
  const auto distortion = compare_pair({options.original, options.decoded});
  if (!distortion) return tl::unexpected(distortion.error());
  if (options.json) {
    nlohmann::ordered_json report;
    add_distortion(report, *distortion);
    print_json(report);
  } else {
    report_text(*distortion);
  }
  return {};
}

Status compare_folders(const CompareOptions& options) {
  const auto pairs = pair_up(options);
  if (!pairs) return tl::unexpected(pairs.error());
  std::vector<NamedDistortion> sweeps;
  lab::DistortionMean mean;
  Progress progress("comparing", pairs->size());
  for (const Pair& pair : *pairs) {
    const auto distortion = compare_pair(pair);
    if (!distortion) return tl::unexpected(distortion.error());
    sweeps.push_back({pair.original.stem().string(), *distortion});
    mean.add(*distortion);
    progress.step(pair.original.filename().string());
  }
  if (options.json) {
    report_json(sweeps, mean.mean());
  } else {
    report_table(sweeps, mean.mean());
  }
  return {};
}

Status compare(const CompareOptions& options) {
  std::error_code ignored;
  const bool original_folder = fs::is_directory(options.original, ignored);
  const bool decoded_folder = fs::is_directory(options.decoded, ignored);
  if (original_folder && decoded_folder) return compare_folders(options);
  if (original_folder || decoded_folder) {
    return fail(ErrorCode::invalid_argument,
                fmt::format("{} is a folder and {} is not; give two files or two folders",
                            original_folder ? options.original : options.decoded,
                            original_folder ? options.decoded : options.original));
  }
  return compare_files(options);
}

}  // namespace

void add_compare(CLI::App& app, Command& command) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* sub = app.add_subcommand("compare", "Measure what decoded clouds lost");
  sub->add_option("ORIGINAL", options->original,
                  "A cloud (.bin, .pcd, .ply), or a folder of clouds")
      ->required();
  sub->add_option("DECODED", options->decoded,
                  "Its decoded copy, or a folder with a file of the same base name for each")
      ->required();
  sub->add_flag("--json", options->json, "Print the figures as JSON");
  sub->footer("Example: sweepcast compare drive/sweeps decoded");
  sub->callback([options, &command] { command = [options] { return compare(*options); }; });
}

}  // namespace sweepcast::app
