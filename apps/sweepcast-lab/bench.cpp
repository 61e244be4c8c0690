// `sweepcast bench`: ratio, distortion and time over settings, beside other codecs.
#include "lab/bench.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/distortion_report.hpp"
#include "common/inputs.hpp"
#include "common/progress.hpp"
#include "io/file.hpp"
#include "lab/plot.hpp"
#include "sweepcast-lab/bench_settings.hpp"
#include "sweepcast-lab/commands.hpp"

namespace sweepcast::app {

namespace {

namespace fs = std::filesystem;
using lab::BenchRow;

struct BenchCommand {
  std::vector<std::string> inputs;
  BenchSettings settings;
  int runs = 5;
  fs::path csv;
  fs::path plot;
  bool stages = false;
  bool json = false;
};

/// A column of the CSV file that is no figure of the distortion.
struct Column {
  const char* name;
  double BenchRow::*value;
};

constexpr std::array<Column, 7> kColumns{{
    {"ratio", &BenchRow::ratio},
    {"bytes", &BenchRow::bytes},
    {"points_in", &BenchRow::points_in},
    {"points_out", &BenchRow::points_out},
    {"points_filled", &BenchRow::points_filled},
    {"encode_ms", &BenchRow::encode_ms},
    {"decode_ms", &BenchRow::decode_ms},
}};

std::string csv_text(const std::vector<BenchRow>& rows) {
  std::string text = "codec,setting";
  for (const Column& column : kColumns) text += fmt::format(",{}", column.name);
  for (const auto& figure : lab::kDistortionFigures) text += fmt::format(",{}", figure.name);
  for (const auto name : lab::kFScoreNames) text += fmt::format(",f_score_{}", name);
  text += '\n';
  for (const BenchRow& row : rows) {
    text += fmt::format("{},\"{}\"", row.codec, row.setting);
    for (const Column& column : kColumns) text += fmt::format(",{}", row.*column.value);
    for (const auto& figure : lab::kDistortionFigures) {
      text += fmt::format(",{}", row.distortion.*figure.value);
    }
    for (const double f_score : row.distortion.f_score) text += fmt::format(",{}", f_score);
    text += '\n';
  }
  return text;
}

Status write_csv(const std::vector<BenchRow>& rows, const fs::path& path) {
  const std::string text = csv_text(rows);
  return write_file(path, std::as_bytes(std::span(text)));
}

void report_json(const std::vector<BenchRow>& rows, std::size_t sweep_count, int runs,
                 const std::vector<std::string>& left_out) {
  nlohmann::ordered_json report{
      {"sweeps", sweep_count}, {"runs", runs}, {"rows", nlohmann::ordered_json::array()}};
  for (const BenchRow& row : rows) {
    nlohmann::ordered_json entry{{"codec", row.codec}, {"setting", row.setting}};
    for (const Column& column : kColumns) entry[column.name] = number_or_null(row.*column.value);
    add_distortion(entry, row.distortion);
    for (const auto& [key, stages] : {std::pair{"encode_stages_ms", &row.encode_stages},
                                      std::pair{"decode_stages_ms", &row.decode_stages}}) {
      for (const lab::StageMean& stage : *stages) entry[key][stage.stage] = stage.ms;
    }
    report["rows"].push_back(std::move(entry));
  }
  report["left_out"] = left_out;
  print_json(report);
}

void report_table(const std::vector<BenchRow>& rows, std::size_t sweep_count, int runs) {
  std::size_t codec_width = 9;
  std::size_t width = 7;
  for (const BenchRow& row : rows) {
    codec_width = std::max(codec_width, row.codec.size());
    width = std::max(width, row.setting.size());
  }
  fmt::print(
      "{:{}} {:{}}   ratio  kept %  mean cm  D1 dB  D2 dB  F 2cm  F 5cm F 10cm F 20cm  "
      "azim deg  elev deg  enc ms  dec ms\n",
      "codec", codec_width, "setting", width);
  for (const BenchRow& row : rows) {
    const lab::Distortion& d = row.distortion;
    fmt::print(
        "{:{}} {:{}} {:>7.1f} {:>7.1f} {:>8.2f} {:>6.2f} {:>6.2f} {:>6.2f} {:>6.2f} {:>6.2f} "
        "{:>6.2f} "
        "{:>+9.4f} {:>+9.4f} {:>7.2f} {:>7.2f}\n",
        row.codec, codec_width, row.setting, width, row.ratio,
        100.0 * row.points_out / row.points_in, 100.0 * d.mean_o2d, d.d1_psnr, d.d2_psnr,
        d.f_score[0], d.f_score[1], d.f_score[2], d.f_score[3], d.mean_azimuth_error_deg,
        d.mean_elevation_error_deg, row.encode_ms, row.decode_ms);
  }
  fmt::print(
      "Mean over {} sweeps; times are CPU time of one thread, median of {} runs a sweep; "
      "ratio: 16 bytes a point (geometry only is coded); mean: original to decoded.\n",
      sweep_count, runs);
}

void report_stages(const std::vector<BenchRow>& rows) {
  for (const BenchRow& row : rows) {
    for (const auto& [what, stages] :
         {std::pair{"encoding", &row.encode_stages}, std::pair{"decoding", &row.decode_stages}}) {
      double sum = 0.0;
      for (const lab::StageMean& stage : *stages) sum += stage.ms;
      if (sum > 0.0) fmt::print("\n{} {}, {}: {:.2f} ms\n", row.codec, row.setting, what, sum);
      for (const lab::StageMean& stage : *stages) {
        fmt::print("  {:28} {:>7.2f} ms {:>5.1f} %\n", stage.stage, stage.ms,
                   100.0 * stage.ms / sum);
      }
    }
  }
}

/// Whether the files can be written, before the time is spent that measuring takes.
Status check_outputs(const BenchCommand& options) {
  if (!options.csv.empty()) {
    if (Status csv = check_writable(options.csv); !csv) return csv;
  }
  return options.plot.empty() ? Status{} : lab::check_plot(options.plot);
}

Status bench(const BenchCommand& options) {
  const auto sweeps = collect_clouds(options.inputs);
  if (!sweeps) return tl::unexpected(sweeps.error());
  auto choice = make_peers(options.settings);
  if (!choice) return tl::unexpected(choice.error());
  lab::Peers& peers = choice->peers;
  if (Status outputs = check_outputs(options); !outputs) return outputs;
  if (Status added = add_bounded_peers(options.settings, *sweeps, peers); !added) return added;
  Progress progress("measuring", sweeps->size());
  const auto on_sweep = [&progress](std::string_view name) { progress.step(name); };
  const auto rows = lab::bench(*sweeps, peers, {.runs = options.runs, .on_sweep = on_sweep});
  if (!rows) return tl::unexpected(rows.error());
  if (options.json) {
    report_json(*rows, sweeps->size(), options.runs, choice->left_out);
  } else {
    report_table(*rows, sweeps->size(), options.runs);
    for (const std::string& absent : choice->left_out) fmt::print("Left out: {}.\n", absent);
    if (options.stages) report_stages(*rows);
  }
  if (!options.csv.empty()) {
    if (Status written = write_csv(*rows, options.csv); !written) return written;
  }
  if (!options.plot.empty()) return lab::plot_rate_distortion(*rows, options.plot);
  return {};
}

}  // namespace

void add_bench(CLI::App& app, Command& command) {
  auto options = std::make_shared<BenchCommand>();
  CLI::App* sub = app.add_subcommand(
      "bench", "Measure ratio, distortion and time over settings, beside other codecs");
  sub->add_option("INPUT", options->inputs, "Clouds (.bin, .pcd, .ply), or folders of them")
      ->required();
  add_bench_settings(*sub, options->settings);
  sub->add_option("--runs", options->runs, "Timed runs of each sweep; the median counts [5]")
      ->check(CLI::Range(1, 1000))
      ->type_name("N");
  sub->add_option("--csv", options->csv, "Write the rows to a file too")->type_name("FILE");
  sub->add_option("--plot", options->plot, "Draw rate-distortion curves (needs gnuplot)")
      ->type_name("FILE.png|FILE.svg");
  sub->add_flag("--stages", options->stages, "Print what the stages of our codecs take, too");
  sub->add_flag("--json", options->json, "Print the rows as JSON");
  sub->footer("Example: sweepcast bench drive --peers draco --plot bench.png");
  sub->callback([options, &command] {
    if (const auto peers = make_peers(options->settings);
        !peers && peers.error().code == ErrorCode::invalid_argument) {
      throw CLI::ValidationError(peers.error().message);
    }
    command = [options] { return bench(*options); };
  });
}

}  // namespace sweepcast::app
