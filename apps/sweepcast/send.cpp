// `sweepcast send`: sweeps to a receiver, live.
#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/interruption.hpp"
#include "common/validators.hpp"
#include "rate/strategy.hpp"
#include "sweepcast/commands.hpp"
#include "sweepcast/link.hpp"
#include "sweepcast/live/feed.hpp"
#include "sweepcast/live/metrics.hpp"
#include "sweepcast/sweep_file.hpp"

namespace sweepcast::app {
namespace {

using std::chrono::steady_clock;

struct SendOptions {
  std::vector<std::string> inputs;
  std::vector<std::string> sensors;
  std::string to;
  std::string key_file;
  std::string record;
  std::string metrics;
  std::string strategy = "budget";
  EncoderOptions encoder;
  double rate_hz = 10.0;
  int deadline_ms = 250;
  std::optional<int> wait_s;  ///< none: 10, but not where it loops
  bool loop = false;
  bool allow_override = false;
  bool json = false;
};

std::string check_strategy(const std::string& text) {
  const auto strategy = make_strategy(text, CodecId::beam);
  return strategy ? "" : strategy.error().message;
}

Result<std::pair<std::string, std::uint16_t>> parse_address(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  const std::string digits = colon == std::string::npos ? "" : text.substr(colon + 1);
  const bool is_number = !digits.empty() && digits.size() <= 5 &&
                         digits.find_first_not_of("0123456789") == std::string::npos;
  const int port = is_number ? std::stoi(digits) : 0;
  if (colon == 0 || port < 1 || port > 65535) {
    return fail(ErrorCode::invalid_argument, text + ": is not HOST:PORT, as in 192.168.1.5:5600");
  }
  return std::pair(text.substr(0, colon), static_cast<std::uint16_t>(port));
}

Result<std::vector<Feed>> open_feeds(const SendOptions& options) {
  std::vector<Feed> feeds;
  for (std::size_t i = 0; i < options.inputs.size(); ++i) {
    const std::string sensor = i < options.sensors.size() ? options.sensors[i] : "lidar";
    auto feed = Feed::open({options.inputs[i], sensor, options.encoder, options.strategy,
                            options.rate_hz, options.loop, options.allow_override});
    if (!feed) return tl::unexpected(feed.error());
    feeds.push_back(std::move(*feed));
  }
  return feeds;
}

class Sending {
 public:
  Sending(const SendOptions& options, std::vector<Feed> feeds, Sender sender)
      : options_(options), feeds_(std::move(feeds)), sender_(std::move(sender)) {}

  Status run();

 private:
  [[nodiscard]] Status wait_for_connection();
  [[nodiscard]] Status never_connected() const;
  [[nodiscard]] Status keep(Feed& feed);
  [[nodiscard]] Status send(Feed& feed, const LinkBudget& budget,
                            steady_clock::time_point captured);
  [[nodiscard]] Status send_all();
  [[nodiscard]] std::vector<Metric> metrics() const;
  [[nodiscard]] std::string line() const;
  void report() const;

  const SendOptions& options_;
  std::vector<Feed> feeds_;
  Sender sender_;
  std::optional<SweepWriter> record_;
};

/// What has an end loses nothing to the time in which the connection is made.
Status Sending::wait_for_connection() {
  constexpr std::chrono::milliseconds kCheck{20};
  constexpr int kWait_s = 10;
  const auto end = steady_clock::now() + std::chrono::seconds(options_.wait_s.value_or(kWait_s));
  StatusLine line;
  while (!sender_.status().connected && !wait_for_stop(steady_clock::now() + kCheck)) {
    if (steady_clock::now() < end) {
      line.update([&] { return this->line(); });
    } else {  // what is recorded is recorded all the same
      return options_.record.empty() ? never_connected() : Status{};
    }
  }
  return {};
}

Status Sending::never_connected() const {
  const std::string error = sender_.status().error;
  return fail(ErrorCode::not_found, options_.to + ": was never connected, so nothing was sent: " +
                                        (error.empty() ? "nobody answers there" : error));
}

/// Adds the sweep to the recording.
Status Sending::keep(Feed& feed) {
  if (!record_) return {};
  const auto frame = feed.full();
  if (!frame) return tl::unexpected(frame.error());
  return record_->append(*frame, feed.name());
}

Status Sending::send(Feed& feed, const LinkBudget& budget, steady_clock::time_point captured) {
  auto sweep = feed.make(budget);
  if (!sweep) return tl::unexpected(sweep.error());
  sweep->captured = captured;
  return sender_.send(*sweep);
}

Status Sending::send_all() {
  const auto interval = std::chrono::duration_cast<steady_clock::duration>(
      std::chrono::duration<double>(1.0 / options_.rate_hz));
  StatusLine line;
  // Sweeps that take longer than the interval are not skipped: the rest comes later.
  for (auto due = steady_clock::now();; due = std::max(due + interval, steady_clock::now())) {
    if (wait_for_stop(due)) return {};
    bool any = false;
    LinkBudget budget = sender_.choose();
    budget.sweep_bytes /= feeds_.size();
    for (Feed& feed : feeds_) {
      const auto there = feed.next();
      if (!there) return tl::unexpected(there.error());
      if (!*there) continue;
      any = true;
      if (Status sent = send(feed, budget, due); !sent) return sent;
      if (Status kept = keep(feed); !kept) return kept;
    }
    if (!any) return {};
    line.update([&] { return this->line(); });
  }
}

Status Sending::run() {
  if (!options_.record.empty()) {
    auto writer = SweepWriter::open(options_.record, SweepWriter::Mode::record);
    if (!writer) return tl::unexpected(writer.error());
    record_ = std::move(*writer);
  }
  std::optional<MetricsServer> server;
  if (!options_.metrics.empty()) {
    auto started =
        MetricsServer::start(metrics_address(options_.metrics), [this] { return metrics(); });
    if (!started) return tl::unexpected(started.error());
    server = std::move(*started);
  }
  Status status;
  if (!options_.loop || options_.wait_s) status = wait_for_connection();
  if (status) status = send_all();
  sender_.finish();
  server.reset();
  if (record_) {
    if (Status closed = record_->close(); !closed && status) status = closed;
  }
  report();
  const SenderStatus s = sender_.status();
  if (!status || s.connections > 0 || s.sweeps == 0 || stop_requested()) return status;
  return never_connected();
}

std::vector<Metric> Sending::metrics() const {
  const SenderStatus s = sender_.status();
  const auto number = [](auto value) { return static_cast<double>(value); };
  std::vector<Metric> metrics{
      {"sweepcast_connected", "1 while there is a receiver", s.connected ? 1.0 : 0.0},
      {"sweepcast_connections_total", "Connections made", number(s.connections)},
      {"sweepcast_sweeps_total", "Sweeps to send", number(s.sweeps)},
      {"sweepcast_sweeps_sent_total", "Sweeps of which all layers left", number(s.sweeps_sent)},
      {"sweepcast_sweeps_cut_total", "Sweeps of which some layers left", number(s.sweeps_cut)},
      {"sweepcast_sweeps_dropped_total", "Sweeps of which none left", number(s.sweeps_dropped)},
      {"sweepcast_packets_total", "Packets sent", number(s.packets)},
      {"sweepcast_packets_retransmitted_total", "... and repeated",
       number(s.packets_retransmitted)},
      {"sweepcast_packets_refused_total", "Packets that were not the receiver's",
       number(s.packets_refused)},
      {"sweepcast_bytes_total", "Bytes of packets sent", number(s.bytes)},
      {"sweepcast_queue_frames", "Sweeps that are not fully sent", number(s.report.queued_frames)},
      {"sweepcast_queue_bytes", "Bytes that wait", number(s.link.queued_bytes)},
      {"sweepcast_queue_delay_seconds", "One-way delay above its least", s.link.queue_delay_s},
      {"sweepcast_round_trip_seconds", "Round trip", s.link.round_trip_s},
      {"sweepcast_receive_rate_bytes", "Bytes a second that arrive", s.link.receive_rate},
      {"sweepcast_budget_sweep_bytes", "Bytes for the next sweeps", number(s.budget.sweep_bytes)},
  };
  if (s.report.level) {
    metrics.push_back({"sweepcast_level", "Level of the newest sweep", number(*s.report.level)});
  }
  if (s.report.qoe) {
    metrics.push_back({"sweepcast_qoe", "Mean QoE of the last sweeps", *s.report.qoe});
  }
  return metrics;
}

std::string Sending::line() const {
  const SenderStatus s = sender_.status();
  if (!s.connected) return options_.to + ": not connected: " + s.error;
  std::string sweep =
      fmt::format("{:.1f} KB a sweep", static_cast<double>(s.budget.sweep_bytes) / 1e3);
  if (s.budget.level) sweep = fmt::format("level {}", *s.budget.level);
  if (s.report.override_level) sweep += ", as the receiver asks";
  return fmt::format("{} sweeps, {} dropped, {}, {:.0f} KB/s arrive, queue {:.1f} KB and {:.0f} ms",
                     s.sweeps, s.sweeps_dropped, sweep, s.link.receive_rate / 1e3,
                     static_cast<double>(s.link.queued_bytes) / 1e3, s.link.queue_delay_s * 1e3);
}

void Sending::report() const {
  const SenderStatus s = sender_.status();
  if (options_.json) {
    print_json({{"sweeps", s.sweeps},
                {"sent", s.sweeps_sent},
                {"cut", s.sweeps_cut},
                {"dropped", s.sweeps_dropped},
                {"packets", s.packets},
                {"retransmitted", s.packets_retransmitted},
                {"bytes", s.bytes},
                {"connections", s.connections}});
    return;
  }
  fmt::print("{} sweeps: {} sent, {} cut, {} dropped; {} bytes in {} packets, {} repeated\n",
             s.sweeps, s.sweeps_sent, s.sweeps_cut, s.sweeps_dropped, s.bytes, s.packets,
             s.packets_retransmitted);
}

Status send(const SendOptions& options) {
  stop_on_signals();  // before anything is written
  const auto address = parse_address(options.to);
  if (!address) return tl::unexpected(address.error());
  const auto keys = read_link_keys(options.key_file);
  if (!keys) return tl::unexpected(keys.error());
  if (keys->size() != 1) {
    return fail(ErrorCode::invalid_argument,
                options.key_file + ": holds the keys of several robots; give this one's alone");
  }
  auto feeds = open_feeds(options);
  if (!feeds) return tl::unexpected(feeds.error());
  SenderOptions sender_options;
  std::tie(sender_options.host, sender_options.port) = *address;
  sender_options.key = keys->front();
  sender_options.deadline = std::chrono::milliseconds(options.deadline_ms);
  sender_options.strategy = options.strategy;
  sender_options.codec = options.encoder.codec;
  sender_options.rate_hz = options.rate_hz;
  sender_options.allow_override = options.allow_override;
  auto sender = Sender::start(std::move(sender_options));
  if (!sender) return tl::unexpected(sender.error());
  return Sending(options, std::move(*feeds), std::move(*sender)).run();
}

std::string check_name(const std::string& name) {
  return is_link_name(name) ? "" : "\"" + name + "\" is not letters, digits, dots and dashes";
}

}  // namespace

void add_send(CLI::App& app, Command& command) {
  auto options = std::make_shared<SendOptions>();
  options->encoder.beam.fields = Fields::xyz;
  CLI::App* sub = app.add_subcommand("send", "Send sweeps to a receiver as a sensor makes them");
  sub->add_option("INPUT", options->inputs,
                  "A folder of clouds, a .sweep file, or - for a .sweep stream; one a sensor")
      ->required();
  sub->add_option("--to", options->to, "The receiver")->type_name("HOST:PORT")->required();
  sub->add_option("--key", options->key_file, "This robot's key, see keygen")
      ->type_name("FILE")
      ->required();
  sub->add_option("--sensor", options->sensors, "The sensor's name, one an INPUT [lidar]")
      ->check(CLI::Validator(check_name, ""))
      ->type_name("NAME");
  sub->add_option("--rate", options->rate_hz, "Sweeps per second [10]")
      ->check(number_between(0.1, 100))
      ->type_name("HZ");
  sub->add_flag("--loop", options->loop, "Begin again at the end, until a signal comes");
  sub->add_option("--strategy", options->strategy,
                  "budget: as many bytes as the link carries; paper, bola, mpc: a level for each "
                  "sweep; fixed:L: one for all [budget]")
      ->check(CLI::Validator(check_strategy, ""))
      ->type_name("NAME");
  sub->add_flag("--allow-override", options->allow_override,
                "Whoever watches at the receiver may ask for a level of clouds, in the strategy's "
                "place");
  sub->add_option("--deadline", options->deadline_ms, "What is older is dropped, ms [250]")
      ->check(CLI::Range(10, 10'000).description(""))
      ->type_name("MS");
  sub->add_option("--wait", options->wait_s,
                  "How long to wait for a receiver before the first sweep, s [10; with --loop 0]")
      ->check(CLI::Range(0, 86'400).description(""))
      ->type_name("S");
  sub->add_option_function<std::string>(
         "--codec",
         [options](const std::string& name) {
           options->encoder.codec = name == "rcpcc" ? CodecId::rcpcc : CodecId::beam;
         },
         "Codec of clouds [beam]")
      ->check(CLI::IsMember({"beam", "rcpcc"}).description(""))
      ->type_name("beam|rcpcc");
  sub->add_option_function<std::string>(
         "--fields",
         [options](const std::string& name) {
           options->encoder.beam.fields =
               name == "all" ? Fields::all : (name == "xyzi" ? Fields::xyzi : Fields::xyz);
         },
         "Which fields of clouds are sent [xyz]")
      ->check(CLI::IsMember({"xyz", "xyzi", "all"}).description(""))
      ->type_name("xyz|xyzi|all");
  sub->add_option("--record", options->record, "Keep all sweeps here, at full quality")
      ->type_name("FILE.sweep");
  sub->add_option("--metrics", options->metrics, "Serve Prometheus text at /metrics")
      ->type_name("[HOST:]PORT");
  sub->add_flag("--json", options->json, "Print the outcome as JSON");
  sub->footer("Example: sweepcast send drive/sweeps --to 192.168.1.5:5600 --key rover.key --loop");
  sub->callback([options, &command] {
    if (options->inputs.size() > 1 && options->sensors.size() != options->inputs.size()) {
      throw CLI::ValidationError("--sensor", "several inputs need a name each");
    }
    command = [options] { return send(*options); };
  });
}

}  // namespace sweepcast::app
