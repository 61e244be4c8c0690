// `sweepcast train-detector`: weights for the detector PointPillars, from simulated drives.
#include <fmt/core.h>

#include <chrono>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "common/progress.hpp"
#include "common/validators.hpp"
#include "io/file.hpp"
#include "lab/detect/train_pillars.hpp"
#include "sweepcast-lab/commands.hpp"

namespace sweepcast::app {

namespace {

struct TrainDetectorCommand {
  std::vector<std::string> drives;
  std::string output;
  int stride = 3;
  lab::TrainOptions options;
};

Result<std::vector<lab::LabelledSweep>> read_drives(const TrainDetectorCommand& options) {
  std::vector<lab::LabelledSweep> sweeps;
  Progress progress("reading drives", options.drives.size());
  for (const std::string& drive : options.drives) {
    auto read = lab::read_drive(drive, options.stride);
    if (!read) return read;
    std::move(read->begin(), read->end(), std::back_inserter(sweeps));
    progress.step();
  }
  return sweeps;
}

Status train_detector(const TrainDetectorCommand& options) {
  if (Status status = check_writable(options.output); !status) return status;
  const auto sweeps = read_drives(options);
  if (!sweeps) return tl::unexpected(sweeps.error());
  const auto begin = std::chrono::steady_clock::now();
  Progress progress("training", static_cast<std::size_t>(options.options.steps));
  double last = 0.0;
  Status trained =
      lab::train_pillars(*sweeps, options.options, options.output, [&](int, double loss) {
        last = loss;
        progress.step(fmt::format("loss {:.3f}", loss));
      });
  if (!trained) return trained;
  const std::chrono::duration<double, std::ratio<60>> spent =
      std::chrono::steady_clock::now() - begin;
  fmt::print("{}: trained on {} sweeps in {:.1f} minutes, loss {:.3f}\n", options.output,
             sweeps->size(), spent.count(), last);
  return {};
}

}  // namespace

void add_train_detector(CLI::App& app, Command& command) {
  const auto options = std::make_shared<TrainDetectorCommand>();
  CLI::App* sub = app.add_subcommand("train-detector", "Train PointPillars on simulated drives");
  sub->footer(
      "The same command on the same machine gives the same weights.\n\n"
      "Example: what this project's weights were made with is in docs/detection.md; in short\n"
      "  sweepcast simulate -o drive101 --seed 101 --sweeps 150\n"
      "  sweepcast train-detector drive101 -o my.weights");
  sub->add_option("DRIVES", options->drives, "Folders that `simulate` made")->required();
  sub->add_option("-o,--output", options->output, "Weights to write")
      ->type_name("FILE")
      ->required();
  sub->add_option("--stride", options->stride, "Take every so many-th sweep")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sub->add_option("--steps", options->options.steps, "Steps of the optimiser")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  sub->add_option("--batch", options->options.batch, "Sweeps a step")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  sub->add_option("--learning-rate", options->options.learning_rate, "The highest one")
      ->check(number_between(1e-6, 1.0))
      ->capture_default_str();
  sub->add_option("--seed", options->options.seed,
                  "Decides first weights, order and changes of the sweeps")
      ->check(whole_number())
      ->capture_default_str();
  sub->add_option("--threads", options->options.threads, "Other numbers give other weights")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  sub->callback([options, &command] { command = [options] { return train_detector(*options); }; });
}

}  // namespace sweepcast::app
