// `sweepcast bench`: ratio, distortion and time over settings, beside other codecs.
#include "lab/bench.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
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
#include "common/validators.hpp"
#include "io/file.hpp"
#include "lab/peers/draco.hpp"
#include "lab/peers/sweepcast_codec.hpp"
#include "lab/plot.hpp"
#include "sweepcast-lab/commands.hpp"
#include "sweepcast/ladder.hpp"

namespace sweepcast::app {

namespace {

namespace fs = std::filesystem;
using lab::BenchRow;

struct BenchCommand {
  std::vector<std::string> inputs;
  std::vector<std::string> codecs{"rcpcc"};
  std::vector<std::string> levels;                                  ///< of the ladder; "all"
  std::vector<std::string> params;                                  ///< further settings of rcpcc
  std::vector<double> max_errors{0.01, 0.02, 0.05, 0.1, 0.2, 0.4};  ///< settings of beam, metres
  std::vector<std::string> peers;
  RcpccOptions rcpcc;  ///< what all settings share
  int runs = 5;
  fs::path csv;
  fs::path plot;
  bool json = false;
};

/// The paper's timing setting (section IV.D).
constexpr std::string_view kPaperSetting = "0.5,0.5,0.3,0.2";

Result<RcpccParams> parse_params(const std::string& text) {
  std::array<double, 4> values{};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto [next, error] = std::from_chars(at, end, values[i]);
    const bool separated = i + 1 < values.size() ? next != end && *next == ',' : next == end;
    if (error != std::errc{} || !separated) {
      return fail(ErrorCode::invalid_argument,
                  fmt::format("--params {}: not AZIMUTH,ELEVATION,THRESHOLD,QSTEP; give four "
                              "numbers separated by commas",
                              text));
    }
    at = next + 1;
  }
  return RcpccParams{values[0], values[1], values[2], values[3]};
}

/// A setting of rcpcc and its label.
struct RcpccSetting {
  std::string label;
  RcpccParams params;
};

/// The chosen levels, or all of them; without any choice, all levels and the paper's setting.
Result<std::vector<RcpccSetting>> rcpcc_settings(const BenchCommand& options) {
  std::vector<RcpccSetting> settings;
  std::vector<std::string> params = options.params;
  std::vector<std::string> levels = options.levels;
  if (levels.empty() && params.empty()) {
    levels = {"all"};
    params = {std::string(kPaperSetting)};
  }
  for (std::size_t level = 0; level < kRcpccLevels.size(); ++level) {
    const auto wanted = [&](const std::string& word) {
      return word == "all" || word == std::to_string(level);
    };
    if (std::any_of(levels.begin(), levels.end(), wanted)) {
      settings.push_back({fmt::format("L{}", level), kRcpccLevels.at(level)});
    }
  }
  for (const std::string& text : params) {
    const auto parsed = parse_params(text);
    if (!parsed) return tl::unexpected(parsed.error());
    settings.push_back({text, *parsed});
  }
  return settings;
}

Status add_rcpcc(const BenchCommand& options, lab::Peers& peers) {
  const auto settings = rcpcc_settings(options);
  if (!settings) return tl::unexpected(settings.error());
  for (const RcpccSetting& setting : *settings) {
    EncoderOptions encoder;
    encoder.codec = CodecId::rcpcc;
    encoder.rcpcc = options.rcpcc;
    encoder.rcpcc.params = setting.params;
    auto peer = lab::make_sweepcast_peer(encoder, setting.label);
    if (!peer) return tl::unexpected(peer.error());
    peers.push_back(std::move(*peer));
  }
  return {};
}

Status add_beam(const BenchCommand& options, lab::Peers& peers) {
  for (const double max_error : options.max_errors) {
    EncoderOptions encoder;
    encoder.codec = CodecId::beam;
    encoder.beam.max_error_m = max_error;
    auto peer = lab::make_sweepcast_peer(encoder, fmt::format("E {} m", max_error));
    if (!peer) return tl::unexpected(peer.error());
    peers.push_back(std::move(*peer));
  }
  return {};
}

Status add_draco(lab::Peers& peers) {
  for (int bits = 8; bits <= 14; ++bits) {
    auto peer = lab::make_draco_peer({.quantisation_bits = bits, .compression_level = 7});
    if (!peer) return tl::unexpected(peer.error());
    peers.push_back(std::move(*peer));
  }
  return {};
}

bool contains(const std::vector<std::string>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Every codec at every setting that the command line asks for.
Result<lab::Peers> make_peers(const BenchCommand& options) {
  lab::Peers peers;
  if (contains(options.codecs, "rcpcc")) {
    if (const Status added = add_rcpcc(options, peers); !added) {
      return tl::unexpected(added.error());
    }
  }
  if (contains(options.codecs, "beam")) {
    if (const Status added = add_beam(options, peers); !added) {
      return tl::unexpected(added.error());
    }
  }
  if (contains(options.peers, "draco")) {
    if (const Status added = add_draco(peers); !added) return tl::unexpected(added.error());
  }
  return peers;
}

/// A column of the CSV file that is no figure of the distortion.
struct Column {
  const char* name;
  double BenchRow::*value;
};

constexpr std::array<Column, 6> kColumns{{
    {"ratio", &BenchRow::ratio},
    {"bytes", &BenchRow::bytes},
    {"points_in", &BenchRow::points_in},
    {"points_out", &BenchRow::points_out},
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

void report_json(const std::vector<BenchRow>& rows, std::size_t sweep_count, int runs) {
  nlohmann::ordered_json report{
      {"sweeps", sweep_count}, {"runs", runs}, {"rows", nlohmann::ordered_json::array()}};
  for (const BenchRow& row : rows) {
    nlohmann::ordered_json entry{{"codec", row.codec}, {"setting", row.setting}};
    for (const Column& column : kColumns) entry[column.name] = number_or_null(row.*column.value);
    add_distortion(entry, row.distortion);
    report["rows"].push_back(std::move(entry));
  }
  print_json(report);
}

void report_table(const std::vector<BenchRow>& rows, std::size_t sweep_count, int runs) {
  std::size_t width = 7;
  for (const BenchRow& row : rows) width = std::max(width, row.setting.size());
  fmt::print(
      "{:9} {:{}}   ratio  kept %  mean cm  D1 dB  D2 dB  F 2cm  F 5cm F 10cm F 20cm  "
      "azim deg  elev deg  enc ms  dec ms\n",
      "codec", "setting", width);
  for (const BenchRow& row : rows) {
    const lab::Distortion& d = row.distortion;
    fmt::print(
        "{:9} {:{}} {:>7.1f} {:>7.1f} {:>8.2f} {:>6.2f} {:>6.2f} {:>6.2f} {:>6.2f} {:>6.2f} "
        "{:>6.2f} "
        "{:>+9.4f} {:>+9.4f} {:>7.2f} {:>7.2f}\n",
        row.codec, row.setting, width, row.ratio, 100.0 * row.points_out / row.points_in,
        100.0 * d.mean_o2d, d.d1_psnr, d.d2_psnr, d.f_score[0], d.f_score[1], d.f_score[2],
        d.f_score[3], d.mean_azimuth_error_deg, d.mean_elevation_error_deg, row.encode_ms,
        row.decode_ms);
  }
  fmt::print(
      "Mean over {} sweeps; times are CPU time of one thread, median of {} runs a sweep; "
      "ratio: 16 bytes a point (geometry only is coded); mean: original to decoded.\n",
      sweep_count, runs);
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
  const auto peers = make_peers(options);
  if (!peers) return tl::unexpected(peers.error());
  if (Status outputs = check_outputs(options); !outputs) return outputs;
  Progress progress("measuring", sweeps->size());
  const auto on_sweep = [&progress](std::string_view name) { progress.step(name); };
  const auto rows = lab::bench(*sweeps, *peers, {.runs = options.runs, .on_sweep = on_sweep});
  if (!rows) return tl::unexpected(rows.error());
  if (options.json) {
    report_json(*rows, sweeps->size(), options.runs);
  } else {
    report_table(*rows, sweeps->size(), options.runs);
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
  sub->add_option("--codec", options->codecs, "Our codecs to measure: rcpcc, beam [rcpcc]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"rcpcc", "beam"}));
  sub->add_option("--levels", options->levels,
                  fmt::format("Levels of rcpcc [all, and --params {}]", kPaperSetting))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"0", "1", "2", "3", "4", "5", "all"}));
  sub->add_option("--params", options->params,
                  "A setting of rcpcc: steps in degrees, threshold and quantiser step in metres; "
                  "may be repeated")
      ->allow_extra_args(false)
      ->type_name("AZIMUTH,ELEVATION,THRESHOLD,QSTEP");
  sub->add_option("--max-error", options->max_errors,
                  "Settings of beam: largest errors in metres [0.01,0.02,0.05,0.1,0.2,0.4]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(number_between(0.001, 2.0))
      ->type_name("METRES");
  sub->add_option("--zstd", options->rcpcc.zstd_level,
                  fmt::format("Level of zstd for all settings [{}]", RcpccOptions{}.zstd_level))
      ->check(CLI::Range(1, 22));
  sub->add_option("--peers", options->peers, "Other codecs: draco (kd-tree, qp 8 to 14, cl 7)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"draco"}));
  sub->add_option("--runs", options->runs, "Timed runs of each sweep; the median counts [5]")
      ->check(CLI::Range(1, 1000))
      ->type_name("N");
  sub->add_option("--csv", options->csv, "Write the rows to a file too")->type_name("FILE");
  sub->add_option("--plot", options->plot, "Draw rate-distortion curves (needs gnuplot)")
      ->type_name("FILE.png|FILE.svg");
  sub->add_flag("--json", options->json, "Print the rows as JSON");
  sub->footer("Example: sweepcast bench drive --peers draco --plot bench.png");
  sub->callback([options, &command] {
    if (const auto peers = make_peers(*options);
        !peers && peers.error().code == ErrorCode::invalid_argument) {
      throw CLI::ValidationError(peers.error().message);
    }
    command = [options] { return bench(*options); };
  });
}

}  // namespace sweepcast::app
