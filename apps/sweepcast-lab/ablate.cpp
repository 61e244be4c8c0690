// `sweepcast ablate`: the paper's ablation tables, with its figures beside ours, and those of our
// own stages.
#include "lab/ablate.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/codec_options.hpp"
#include "common/distortion_report.hpp"
#include "common/inputs.hpp"
#include "common/progress.hpp"
#include "common/validators.hpp"
#include "lab/ablate_beam.hpp"
#include "sweepcast-lab/commands.hpp"

namespace sweepcast::app {

namespace {

using lab::ModelRow;
using lab::UnfitRow;

struct AblateCommand {
  std::vector<std::string> inputs;
  std::vector<double> steps{0.5, 0.5};
  std::string codec = "rcpcc";
  double max_error_m = 0.05;
  std::string effort = "default";
  std::string quantiser = "nearest";
  double threshold_m = 0.3;
  RcpccOptions rcpcc;
  bool json = false;

  AblateCommand() { rcpcc.region_size = 32; }  // nearest to the paper, which has no regions
};

std::string_view model_name(SurfaceModel model) {
  return model == SurfaceModel::plane ? "plane" : "surface";
}

std::string coding_name(const UnfitRow& row) {
  return row.coding == UnfitCoding::raw ? "no compression"
                                        : fmt::format("SA-DCT ({:.2f})", row.quantiser_step_m);
}

/// Metres in centimetres, the unit of the paper's tables.
double cm(double metres) {
  return 100.0 * metres;
}

void report_json(const lab::Ablation& tables) {
  nlohmann::ordered_json report{{"models", nlohmann::ordered_json::array()},
                                {"unfit", nlohmann::ordered_json::array()}};
  for (const ModelRow& row : tables.models) {
    report["models"].push_back({{"model", model_name(row.model)},
                                {"threshold", row.threshold_m},
                                {"fitted_mae_cm", number_or_null(cm(row.ours.fitted_mae_m))},
                                {"fitted_share", number_or_null(row.ours.fitted_share)},
                                {"paper_fitted_mae_cm", row.paper_fitted_mae_cm}});
  }
  for (const UnfitRow& row : tables.unfit) {
    const bool raw = row.coding == UnfitCoding::raw;
    nlohmann::ordered_json entry{{"coding", raw ? "raw" : "sa_dct"}};
    entry["quantiser_step"] = raw ? nullptr : nlohmann::ordered_json(row.quantiser_step_m);
    entry["unfit_mae_cm"] = number_or_null(cm(row.ours.unfit_mae_m));
    entry["fitted_mae_cm"] = number_or_null(cm(row.ours.fitted_mae_m));
    entry["mae_cm"] = number_or_null(cm(row.ours.mae_m));
    entry["fitted_share"] = number_or_null(row.ours.fitted_share);
    entry["ratio"] = row.ours.ratio;
    entry["paper_unfit_mae_cm"] = row.paper_unfit_mae_cm;
    entry["paper_mae_cm"] = row.paper_mae_cm;
    entry["paper_ratio"] = row.paper_ratio;
    report["unfit"].push_back(std::move(entry));
  }
  print_json(report);
}

void report_text(const lab::Ablation& tables, const AblateCommand& options,
                 std::size_t sweep_count) {
  fmt::print("Fitted cells, mean absolute error of the range, cm\n");
  fmt::print("  model    threshold     ours    paper   fitted %\n");
  for (const ModelRow& row : tables.models) {
    fmt::print("  {:7} {:>8.1f} m {:>8.2f} {:>8.2f} {:>10.1f}\n", model_name(row.model),
               row.threshold_m, cm(row.ours.fitted_mae_m), row.paper_fitted_mae_cm,
               100.0 * row.ours.fitted_share);
  }
  fmt::print("\nUnfit cells at threshold {:g} m; mean absolute errors in cm\n",
             options.threshold_m);
  fmt::print("                  unfit error       all cells         ratio\n");
  fmt::print("                  ours   paper    ours   paper    ours   paper\n");
  for (const UnfitRow& row : tables.unfit) {
    fmt::print("  {:14} {:>7.2f} {:>7.2f} {:>7.2f} {:>7.2f} {:>7.1f} {:>7.1f}\n", coding_name(row),
               cm(row.ours.unfit_mae_m), row.paper_unfit_mae_cm, cm(row.ours.mae_m),
               row.paper_mae_cm, row.ours.ratio, row.paper_ratio);
  }
  fmt::print(
      "\n{} sweeps at steps of {:g} and {:g} degrees, quantiser: {}. Errors are against the ranges "
      "in the cells, whole millimetres. The paper's figures are of 1,000 sweeps.\n",
      sweep_count, options.steps[0], options.steps[1], options.quantiser);
}

void report_stages_json(const std::vector<lab::StageRow>& rows) {
  nlohmann::ordered_json report{{"stages", nlohmann::ordered_json::array()}};
  for (const lab::StageRow& row : rows) {
    report["stages"].push_back({{"without", row.stage},
                                {"instead", row.instead},
                                {"bytes", row.bytes},
                                {"factor", row.factor}});
  }
  print_json(report);
}

void report_stages_text(const std::vector<lab::StageRow>& rows, std::size_t sweep_count,
                        double max_error_m) {
  fmt::print("{:20} {:45} {:>8} {:>7}\n", "without", "instead", "bytes", "factor");
  for (const lab::StageRow& row : rows) {
    fmt::print("{:20} {:45} {:>8.0f} {:>7.3f}\n", row.stage.empty() ? "-" : row.stage, row.instead,
               row.bytes, row.factor);
  }
  fmt::print(
      "Bytes of a frame, mean over {} sweeps, geometry only; bound {:g} m but for level 4.\n",
      sweep_count, max_error_m);
}

Status ablate_stages(const AblateCommand& options) {
  const auto sweeps = collect_clouds(options.inputs);
  if (!sweeps) return tl::unexpected(sweeps.error());
  lab::StageAblationOptions ablation;
  ablation.max_error_m = options.max_error_m;
  ablation.effort = effort_words().at(options.effort);
  Progress progress("measuring", sweeps->size());
  ablation.on_sweep = [&progress](std::string_view name) { progress.step(name); };
  const auto rows = lab::ablate_stages(*sweeps, ablation);
  if (!rows) return tl::unexpected(rows.error());
  if (options.json) {
    report_stages_json(*rows);
  } else {
    report_stages_text(*rows, sweeps->size(), options.max_error_m);
  }
  return {};
}

/// What all rows of the tables share.
RcpccOptions base_of(const AblateCommand& options) {
  RcpccOptions base = options.rcpcc;
  base.params.azimuth_step_deg = options.steps[0];
  base.params.elevation_step_deg = options.steps[1];
  base.params.threshold_m = options.threshold_m;
  base.rounding = options.quantiser == "truncate" ? Rounding::truncate : Rounding::nearest;
  return base;
}

Status ablate(const AblateCommand& options) {
  const auto sweeps = collect_clouds(options.inputs);
  if (!sweeps) return tl::unexpected(sweeps.error());
  lab::AblationOptions ablation{base_of(options)};
  Progress progress("measuring", sweeps->size());
  ablation.on_sweep = [&progress](std::string_view name) { progress.step(name); };
  const auto tables = lab::ablate(*sweeps, ablation);
  if (!tables) return tl::unexpected(tables.error());
  if (options.json) {
    report_json(*tables);
  } else {
    report_text(*tables, options, sweeps->size());
  }
  return {};
}

/// Refuses options that the tables of the chosen codec do not depend on.
void require_of_codec(const CLI::App& app, bool is_beam) {
  const std::vector<const char*> others =
      is_beam ? std::vector{"--params", "--threshold", "--quantiser", "--block", "--region"}
              : std::vector{"--max-error"};
  for (const char* option : others) {
    if (app.get_option(option)->count() == 0) continue;
    const char* codec = is_beam ? "rcpcc" : "beam";
    throw CLI::ValidationError(
        option, fmt::format("goes with --codec {}; leave it out, or choose that codec", codec));
  }
}

}  // namespace

void add_ablate(CLI::App& app, Command& command) {
  auto options = std::make_shared<AblateCommand>();
  CLI::App* sub = app.add_subcommand("ablate", "Measure what each of the method's ideas is worth");
  sub->add_option("INPUT", options->inputs, "Clouds (.bin, .pcd, .ply), or folders of them")
      ->required();
  sub->add_option("--codec", options->codec,
                  "rcpcc: the paper's tables; beam: bytes without each of its stages [rcpcc]")
      ->check(CLI::IsMember({"rcpcc", "beam"}));
  sub->add_option("--max-error", options->max_error_m, "Codec beam: bound in metres [0.05]")
      ->check(number_between(0.001, 2.0))
      ->type_name("METRES");
  sub->add_option("--effort", options->effort,
                  "Codec beam: time spent to save bytes, fast, default or best [default]")
      ->check(CLI::IsMember({"fast", "default", "best"}));
  sub->add_option("--params", options->steps, "Steps of the range image in degrees [0.5,0.5]")
      ->delimiter(',')
      ->expected(2)
      ->type_name("AZIMUTH,ELEVATION");
  sub->add_option("--threshold", options->threshold_m,
                  "Threshold of the second table in metres, which the paper does not tell [0.3]")
      ->type_name("METRES");
  sub->add_option("--quantiser", options->quantiser,
                  "How the quantiser rounds; truncate is what the released code does [nearest]")
      ->check(CLI::IsMember({"nearest", "truncate"}));
  sub->add_option("--block", options->rcpcc.block_size, "Side of a macroblock in cells [4]")
      ->check(CLI::IsMember({4, 8, 16}));
  sub->add_option("--region", options->rcpcc.region_size,
                  "Side of an SA-DCT region in cells; the paper transforms the whole image [32]")
      ->check(CLI::IsMember({4, 8, 16, 32}));
  sub->add_flag("--json", options->json, "Print the tables as JSON");
  sub->footer("Example: sweepcast ablate drive --quantiser truncate");
  sub->callback([options, sub, &command] {
    const bool is_beam = options->codec == "beam";
    require_of_codec(*sub, is_beam);
    EncoderOptions encoder;
    encoder.codec = CodecId::rcpcc;
    encoder.rcpcc = base_of(*options);
    require_valid(encoder);
    command = [options, is_beam] { return is_beam ? ablate_stages(*options) : ablate(*options); };
  });
}

}  // namespace sweepcast::app
