// `sweepcast evaluate`: what each codec does to the tasks that a drive is for.
#include "lab/evaluate/evaluate.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/build_info.hpp"
#include "common/inputs.hpp"
#include "common/progress.hpp"
#include "common/validators.hpp"
#include "io/file.hpp"
#include "lab/evaluate/curve.hpp"
#include "lab/evaluate/report.hpp"
#include "lab/evaluate/results.hpp"
#include "lab/evaluate/settings.hpp"
#include "lab/evaluate/tasks.hpp"
#include "lab/peers/registry.hpp"
#include "sweepcast-lab/commands.hpp"
#include "sweepcast-lab/detectors.hpp"

namespace sweepcast::app {

namespace {

namespace fs = std::filesystem;

struct EvaluateCommand {
  std::string drive;
  std::string output;
  std::vector<std::string> tasks{lab::kTaskNames.begin(), lab::kTaskNames.end()};
  std::size_t sweeps = 0;
  lab::SettingOptions settings;
  lab::TaskOptions task_options;
  lab::EvaluateOptions evaluate;
  bool json = false;
};

Result<lab::DriveFiles> open_drive(const EvaluateCommand& options) {
  auto sweeps = collect_clouds({options.drive});
  if (!sweeps) return tl::unexpected(std::move(sweeps.error()));
  if (options.sweeps > 0 && options.sweeps < sweeps->size()) sweeps->resize(options.sweeps);
  return lab::open_drive(options.drive, std::move(*sweeps));
}

/// The drive's name for a title: the last part of its path.
std::string name_of(const fs::path& folder) {
  std::error_code error;
  fs::path path = fs::absolute(folder, error).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  return path.filename().string();
}

std::vector<std::string> sampling_of(const lab::Tasks& tasks, std::size_t sweeps) {
  std::vector<std::string> text;
  for (const auto& task : tasks) {
    const std::size_t taken = (sweeps + task->every() - 1) / task->every();
    const std::string which =
        task->every() == 1 ? std::string("all") : fmt::format("every {}th", task->every());
    text.push_back(fmt::format("{}: {} of {} sweeps ({}){}{}", task->name(), taken, sweeps,
                               task->every() == 2 ? "every second" : which,
                               task->means().empty() ? "" : ", by ", task->means()));
  }
  return text;
}

Status write_text(const fs::path& file, const std::string& text) {
  return write_file(file, std::as_bytes(std::span(text)));
}

Status write_results(const fs::path& folder, const lab::Evaluation& evaluation,
                     const lab::ReportText& text) {
  const auto json = lab::results_json(evaluation.rows);
  constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;
  const std::vector<std::pair<std::string, std::string>> files{
      {"results.json", json.dump(1, ' ', false, kReplace) + "\n"},
      {"results.csv", lab::results_csv(evaluation.rows)},
      {"parts.csv", lab::parts_csv(evaluation.rows)},
      {"report.html", lab::report_page(evaluation.rows, text)}};
  for (const auto& [name, content] : files) {
    if (Status written = write_text(folder / name, content); !written) return written;
  }
  return {};
}

void print_outcome(const EvaluateCommand& options, const lab::Evaluation& evaluation,
                   const lab::ReportText& text) {
  if (options.json) {
    print_json(lab::results_json(evaluation.rows));
    return;
  }
  fmt::print("{}: {} settings of codecs; {} results measured, {} had from before\n",
             (fs::path(options.output) / "report.html").string(), evaluation.rows.size(),
             evaluation.measured, evaluation.kept);
  for (const std::string& task : text.tasks) fmt::print("{}\n", task);
  for (const std::string& absent : text.left_out) fmt::print("Left out: {}\n", absent);
  for (const lab::Standing& standing : lab::standings_of(evaluation.rows)) {
    if (standing.is_ahead()) continue;
    fmt::print("Not ahead: {}, ratio {}: beam {:.3f}, {} {:.3f}\n", standing.metric->title,
               standing.ratio, standing.ours, standing.rival, standing.theirs);
  }
}

Result<lab::Evaluation> run_evaluation(const EvaluateCommand& options, const lab::DriveFiles& drive,
                                       const lab::Peers& peers, const lab::Tasks& tasks) {
  const auto cache = lab::ResultCache::open(fs::path(options.output) / "cache");
  if (!cache) return tl::unexpected(cache.error());
  lab::EvaluateOptions evaluate = options.evaluate;
  evaluate.version = kVersion;
  std::optional<Progress> progress;
  evaluate.on_progress = [&](std::size_t done, std::size_t total, std::string_view what) {
    if (done == 0) {
      progress.emplace("evaluating", total);
    } else {
      progress->step(what);
    }
  };
  return lab::evaluate(drive, peers, tasks, *cache, evaluate);
}

/// A size that a codec cannot reach is left out; anything else is a failure.
Status check_failures(const lab::Evaluation& evaluation) {
  std::size_t count = 0;
  for (const Error& failure : evaluation.failures) {
    if (failure.code == ErrorCode::limit) continue;
    print_error(failure.message);
    ++count;
  }
  if (count == 0) return {};
  return fail(ErrorCode::io,
              fmt::format("{} results are missing from the report, for the reasons above; the same "
                          "command measures them and nothing else",
                          count));
}

Status evaluate(const EvaluateCommand& options) {
  const auto drive = open_drive(options);
  if (!drive) return tl::unexpected(drive.error());
  std::error_code error;
  fs::create_directories(options.output, error);
  if (error) return io_failure(options.output, "cannot be made a folder", error.value());
  lab::TaskOptions task_options = options.task_options;
  if (task_options.weights.empty()) {
    task_options.weights = shipped_weights();
  } else if (const auto detector = lab::make_pillar_detector(task_options.weights); !detector) {
    return tl::unexpected(detector.error());  // what was named is not to be left out in silence
  }
  auto tasks = lab::make_tasks(options.tasks, *drive, task_options);
  if (!tasks) return tl::unexpected(std::move(tasks.error()));
  auto settings = lab::make_settings(options.settings, *drive);
  if (!settings) return tl::unexpected(std::move(settings.error()));
  auto evaluation = run_evaluation(options, *drive, settings->peers, tasks->tasks);
  if (!evaluation) return tl::unexpected(std::move(evaluation.error()));
  if (evaluation->rows.empty()) return tl::unexpected(evaluation->failures.front());

  lab::ReportText text{name_of(options.drive), drive->sweeps.size(), kVersion,
                       sampling_of(tasks->tasks, drive->sweeps.size()), std::move(tasks->left_out)};
  std::move(settings->left_out.begin(), settings->left_out.end(),
            std::back_inserter(text.left_out));
  for (const Error& failure : evaluation->failures) text.left_out.push_back(failure.message);
  if (Status written = write_results(options.output, *evaluation, text); !written) return written;
  if (evaluation->damaged > 0) {
    print_note(fmt::format("{}: {} results in cache/ were damaged and measured again",
                           options.output, evaluation->damaged));
  }
  print_outcome(options, *evaluation, text);
  return check_failures(*evaluation);
}

void add_choices(CLI::App& sub, EvaluateCommand& options) {
  std::vector<std::string> tasks(lab::kTaskNames.begin(), lab::kTaskNames.end());
  sub.add_option("--tasks", options.tasks,
                 "What the sweeps are for: distortion, odometry, mesh, detection [all of them]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(items_of(tasks))
      ->type_name("NAME,...");
  sub.add_option("--codec", options.settings.codecs, "Our codecs: beam, rcpcc [both]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(items_of({"beam", "rcpcc"}))
      ->type_name("NAME,...");
  std::vector<std::string> peers{"all", "none"};
  for (const lab::PeerKind& kind : lab::peer_kinds()) peers.emplace_back(kind.name);
  sub.add_option("--peers", options.settings.peers,
                 "Other codecs, by their names in `bench`; all: those that are there; none [all]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(items_of(peers))
      ->type_name("NAME,...|all|none");
  sub.add_option("--ratios", options.settings.ratios, "Ratios that beam is aimed at")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(number_between(1.0, 10'000.0))
      ->type_name("R,...")
      ->capture_default_str();
  sub.add_option("--settings", options.settings.settings_each,
                 "Settings of each of the others, spread over its ladder; 0: all")
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
}

}  // namespace

void add_evaluate(CLI::App& app, Command& command) {
  const auto options = std::make_shared<EvaluateCommand>();
  CLI::App* sub = app.add_subcommand(
      "evaluate", "Report what each codec does to odometry, meshing and detection on a drive");
  sub->footer(
      "Writes DIR/report.html, results.json, results.csv and parts.csv. DIR/cache keeps what was\n"
      "measured: a run that was stopped goes on where it was, and one of the same sweeps,\n"
      "settings and version measures nothing.\n\n"
      "Example:\n"
      "  sweepcast simulate -o drive --sweeps 200\n"
      "  sweepcast evaluate drive -o report");
  sub->add_option("DRIVE", options->drive,
                  "A folder of sweeps, with poses.txt, boxes/ and mesh.ply as far as there are")
      ->required();
  sub->add_option("-o,--output", options->output, "Folder to write")->type_name("DIR")->required();
  add_choices(*sub, *options);
  sub->add_option("--sweeps", options->sweeps, "Only so many, from the first on; 0: all")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  sub->add_flag("--full", options->task_options.full,
                "All sweeps for every task; else distortion takes every fifth, detection every "
                "second");
  sub->add_option("--weights", options->task_options.weights,
                  "PointPillars' weights, for detection [those that come with the program]")
      ->type_name("FILE");
  sub->add_option("--threads", options->evaluate.threads, "Settings at a time; 0: one a core")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  sub->add_flag("--fresh", options->evaluate.fresh, "Measure everything again");
  sub->add_flag("--json", options->json, "Print results.json");
  sub->callback([options, &command] {
    if (options->settings.peers == std::vector<std::string>{"none"}) options->settings.peers = {};
    command = [options] { return evaluate(*options); };
  });
}

}  // namespace sweepcast::app
