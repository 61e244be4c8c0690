// `sweepcast simulate-link`: bitrate strategies over a link, in virtual time.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/inputs.hpp"
#include "common/progress.hpp"
#include "common/validators.hpp"
#include "io/file.hpp"
#include "lab/stream/compare.hpp"
#include "lab/stream/plot_stream.hpp"
#include "sweepcast-lab/commands.hpp"

namespace sweepcast::app {

namespace {

namespace fs = std::filesystem;
using lab::Stream;
using lab::StreamSummary;

/// What `--strategy all` stands for.
const std::vector<std::string> kAllStrategies{"paper", "fixed:0", "bola",
                                              "mpc",   "budget",  "offline"};

/// What `--strategy` takes.
const std::vector<std::string> kStrategyNames{"budget",  "paper",   "bola",    "mpc",
                                              "fixed:0", "fixed:1", "fixed:2", "fixed:3",
                                              "fixed:4", "fixed:5", "offline", "all"};

struct SimulateLinkCommand {
  std::vector<std::string> inputs;
  std::string trace = "paper";
  std::string codec = "beam";
  std::vector<std::string> strategies{"all"};
  double duration_s = 0.0;
  double rate_hz = 10.0;
  double delay_ms = 0.0, jitter_ms = 0.0, loss_percent = 0.0, reordering_percent = 0.0;
  LinkOptions link;
  fs::path csv;
  fs::path plot;
  bool json = false;
};

lab::SessionOptions session_of(const SimulateLinkCommand& options, const Trace& trace) {
  lab::SessionOptions session;
  session.link = options.link;
  session.link.delay_us = std::llround(options.delay_ms * 1e3);
  session.link.jitter_us = std::llround(options.jitter_ms * 1e3);
  session.link.loss = options.loss_percent / 100.0;
  session.link.reordering = options.reordering_percent / 100.0;
  session.rate_hz = options.rate_hz;
  const double seconds =
      options.duration_s > 0.0 ? options.duration_s : static_cast<double>(trace.period_us) * 1e-6;
  session.sweeps = static_cast<std::size_t>(std::max(1.0, std::floor(seconds * options.rate_hz)));
  return session;
}

void report_json(const std::vector<Stream>& streams) {
  auto report = nlohmann::ordered_json::array();
  for (const Stream& stream : streams) {
    const StreamSummary& s = stream.summary;
    report.push_back({{"strategy", s.strategy},
                      {"codec", s.codec},
                      {"trace", s.trace},
                      {"sweeps", s.sweeps},
                      {"mean_qoe", s.mean_qoe},
                      {"age_p50_ms", s.age_p50_ms},
                      {"age_p95_ms", s.age_p95_ms},
                      {"age_p99_ms", s.age_p99_ms},
                      {"outage_share", s.outage_share},
                      {"delivered_150ms", s.delivered_150ms},
                      {"dropped", s.dropped},
                      {"bytes_sent", s.bytes_sent},
                      {"mean_f10", s.mean_f10},
                      {"mean_d2", s.mean_d2}});
  }
  print_json(report);
}

void report_table(const std::vector<Stream>& streams) {
  fmt::print("{:9} {:>8} {:>9} {:>9} {:>9} {:>9} {:>8} {:>9} {:>7} {:>7}\n", "strategy", "QoE",
             "age p50", "age p95", "age p99", "in 150 ms", "dropped", "kB/s", "F 10cm", "D2 dB");
  for (const Stream& stream : streams) {
    const StreamSummary& s = stream.summary;
    const double seconds = static_cast<double>(stream.fates.back().ready_us) * 1e-6;
    fmt::print(
        "{:9} {:>8.2f} {:>6.0f} ms {:>6.0f} ms {:>6.0f} ms {:>7.1f} % {:>8} {:>9.1f} {:>7.2f} "
        "{:>7.2f}\n",
        s.strategy, s.mean_qoe, s.age_p50_ms, s.age_p95_ms, s.age_p99_ms, 100.0 * s.delivered_150ms,
        s.dropped, static_cast<double>(s.bytes_sent) * 1e-3 / seconds, s.mean_f10, s.mean_d2);
  }
  const StreamSummary& s = streams.front().summary;
  fmt::print(
      "{} sweeps as {} over {}; QoE: equation 5, mean of a sweep; age of the newest decoded sweep "
      "and sweeps decoded within 150 ms, without the {:.1f} % of seconds in which the link offers "
      "under 15 kB; dropped: nothing arrived; F and D2: mean over all sweeps, 0 where dropped.\n",
      s.sweeps, s.codec, s.trace, 100.0 * s.outage_share);
}

std::string csv_text(const std::vector<Stream>& streams, const Trace& trace) {
  std::string text =
      "strategy,time_s,offered_bytes,setting,layers,queued_frames,queued_bytes,bytes,decoded_ms,"
      "quality,f10,d2\n";
  for (const Stream& stream : streams) {
    const auto seconds = static_cast<std::size_t>(stream.fates.back().ready_us / 1'000'000) + 1;
    const auto offered = bytes_per_second(trace, seconds);
    for (std::size_t i = 0; i < stream.fates.size(); ++i) {
      const lab::SweepFate& fate = stream.fates[i];
      const bool arrived = fate.sent.layers > 0;
      text += fmt::format(
          "{},{},{},{},{},{},{},{},{},{},{},{}\n", stream.summary.strategy,
          static_cast<double>(fate.ready_us) * 1e-6,
          offered[static_cast<std::size_t>(fate.ready_us / 1'000'000)], fate.sent.setting,
          fate.sent.layers, fate.queued_frames, fate.queued_bytes, fate.bytes,
          arrived ? fmt::format("{}", static_cast<double>(fate.decoded_us - fate.ready_us) * 1e-3)
                  : "",
          stream.qoe[i].quality, stream.quality[i].f10, stream.quality[i].d2);
    }
  }
  return text;
}

Status simulate_link(const SimulateLinkCommand& options) {
  const auto sweeps = collect_clouds(options.inputs);
  if (!sweeps) return tl::unexpected(sweeps.error());
  const auto trace = read_trace(options.trace);
  if (!trace) return tl::unexpected(trace.error());
  if (!options.csv.empty()) {
    if (Status csv = check_writable(options.csv); !csv) return csv;
  }
  if (!options.plot.empty()) {
    if (Status plot = lab::check_plot(options.plot); !plot) return plot;
  }
  lab::StreamComparison comparison;
  comparison.codec = options.codec == "rcpcc" ? CodecId::rcpcc : CodecId::beam;
  comparison.session = session_of(options, *trace);
  const auto& chosen = options.strategies;
  const bool all = std::find(chosen.begin(), chosen.end(), "all") != chosen.end();
  comparison.strategies = all ? kAllStrategies : options.strategies;
  Progress progress("encoding", sweeps->size());
  comparison.on_encoded = [&progress](std::string_view name) { progress.step(name); };
  const auto streams = lab::compare_streams(*sweeps, *trace, comparison);
  if (!streams) return tl::unexpected(streams.error());
  if (options.json) {
    report_json(*streams);
  } else {
    report_table(*streams);
  }
  if (!options.csv.empty()) {
    const std::string text = csv_text(*streams, *trace);
    if (Status written = write_file(options.csv, std::as_bytes(std::span(text))); !written) {
      return written;
    }
  }
  return options.plot.empty() ? Status{} : lab::plot_streams(*streams, *trace, options.plot);
}

void add_link_options(CLI::App& app, SimulateLinkCommand& options) {
  app.add_option("--delay", options.delay_ms, "One way, of every packet [0]")
      ->check(number_between(0.0, 60'000.0))
      ->type_name("MS");
  app.add_option("--jitter", options.jitter_ms, "Further delay, from 0 to this at random [0]")
      ->check(number_between(0.0, 60'000.0))
      ->type_name("MS");
  app.add_option("--loss", options.loss_percent, "Packets lost, and sent again [0]")
      ->check(number_between(0.0, 90.0))
      ->type_name("PERCENT");
  app.add_option("--reorder", options.reordering_percent, "Packets that come 20 ms late [0]")
      ->check(number_between(0.0, 100.0))
      ->type_name("PERCENT");
  app.add_option("--queue-limit", options.link.queue_limit,
                 "Frames that find no room in a queue of this size are dropped [none]")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 40))
      ->type_name("BYTES");
  app.add_option("--seed", options.link.seed, "Decides jitter, losses and reordering [1]")
      ->check(whole_number());
}

}  // namespace

void add_simulate_link(CLI::App& app, Command& command) {
  auto options = std::make_shared<SimulateLinkCommand>();
  CLI::App* sub = app.add_subcommand(
      "simulate-link", "Stream sweeps over a recorded link in virtual time, by each strategy");
  sub->add_option("--sweeps", options->inputs, "Clouds (.bin, .pcd, .ply), or folders of them")
      ->type_name("DIR")
      ->required();
  sub->add_option("--trace", options->trace,
                  "A mahimahi trace, a .schedule, or paper: that of the RCPCC paper [paper]")
      ->type_name("FILE");
  sub->add_option("--codec", options->codec, "rcpcc or beam [beam]")
      ->check(CLI::IsMember({"rcpcc", "beam"}));
  sub->add_option("--strategy", options->strategies,
                  "budget, paper, bola, mpc, fixed:0 to fixed:5, offline; several, or all [all]")
      ->delimiter(',')
      ->check(items_of(kStrategyNames))
      ->type_name("NAME,...");
  sub->add_option("--duration", options->duration_s, "Length of the drive [the trace's]")
      ->check(number_between(0.1, 86'400.0))
      ->type_name("SECONDS");
  sub->add_option("--rate", options->rate_hz, "Sweeps a second; those of DIR, over and over [10]")
      ->check(number_between(0.1, 100.0))
      ->type_name("HZ");
  add_link_options(*sub, *options);
  sub->add_option("--csv", options->csv, "Write what became of each sweep")->type_name("FILE");
  sub->add_option("--plot", options->plot, "Draw bandwidth, level, queue and QoE (needs gnuplot)")
      ->type_name("FILE.png|.svg");
  sub->add_flag("--json", options->json, "Print the figures as JSON");
  sub->footer("Example: sweepcast simulate-link --trace paper --codec rcpcc --sweeps drive/sweeps");
  sub->callback([options, &command] { command = [options] { return simulate_link(*options); }; });
}

}  // namespace sweepcast::app
