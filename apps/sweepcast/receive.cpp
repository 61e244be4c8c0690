// `sweepcast receive`: sweeps from robots, live.
#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/interruption.hpp"
#include "sweepcast/commands.hpp"
#include "sweepcast/link.hpp"
#include "sweepcast/live/arrivals.hpp"
#include "sweepcast/live/metrics.hpp"
#include "view/server.hpp"

namespace sweepcast::app {
namespace {

struct ReceiveOptions {
  ReceiverOptions receiver;
  std::string keys_file;
  std::string output;
  std::string metrics;
  std::string view;  ///< [ADDRESS:]PORT; empty: nothing is shown
  view::ServerOptions viewer;
  bool json = false;
};

std::vector<Metric> metrics_of(const ReceiverStatus& s, const Arrivals::Figures& f) {
  const auto number = [](auto value) { return static_cast<double>(value); };
  return {
      {"sweepcast_peers", "Robots that are connected", number(s.peers)},
      {"sweepcast_connections_total", "Connections made", number(s.connections)},
      {"sweepcast_connections_refused_total", "Attempts without a right key",
       number(s.connections_refused)},
      {"sweepcast_sweeps_whole_total", "Sweeps with all their layers", number(s.sweeps_whole)},
      {"sweepcast_sweeps_cut_total", "Sweeps with fewer", number(s.sweeps_cut)},
      {"sweepcast_sweeps_missed_total", "Sweeps with none", number(s.sweeps_missed)},
      {"sweepcast_sweeps_written_total", "Sweeps written", number(f.written)},
      {"sweepcast_sweeps_unwritten_total", "Sweeps that could not be", number(f.lost)},
      {"sweepcast_unwritten_bytes", "Bytes that wait for the disk", number(f.waiting_bytes)},
      {"sweepcast_frame_bytes_total", "Bytes of frames delivered", number(f.bytes)},
      {"sweepcast_packets_total", "Authentic packets", number(s.packets)},
      {"sweepcast_bytes_total", "Bytes of them", number(s.bytes)},
      {"sweepcast_packets_forged_total", "Packets without the key", number(s.packets_forged)},
      {"sweepcast_packets_replayed_total", "Packets seen before", number(s.packets_replayed)},
      {"sweepcast_packets_malformed_total", "Packets of no sense", number(s.packets_malformed)},
      {"sweepcast_packets_late_total", "Packets of sweeps that were over", number(s.packets_late)},
      {"sweepcast_packets_over_limit_total", "Packets that memory had no room for",
       number(s.packets_over_limit)},
      {"sweepcast_buffered_bytes", "Bytes of sweeps not yet whole", number(s.buffered_bytes)},
      {"sweepcast_age_seconds", "Age of the newest sweep when it was delivered", s.newest_age_s},
  };
}

/// What the senders of robots that are connected tell.
std::vector<Metric> metrics_of(const std::vector<RobotStatus>& robots) {
  const auto number = [](auto value) { return static_cast<double>(value); };
  std::vector<Metric> metrics;
  const auto add = [&](const char* name, const char* help, auto figure) {
    for (const RobotStatus& robot : robots) {
      if (!robot.connected || !robot.report) continue;
      const auto value = figure(*robot.report);
      if (value) metrics.push_back({name, help, number(*value), robot.robot});
    }
  };
  using R = SenderReport;
  add("sweepcast_robot_level", "Level of its newest sweep", [](const R& r) { return r.level; });
  add("sweepcast_robot_override_level", "Level that it was asked for and sends",
      [](const R& r) { return r.override_level; });
  add("sweepcast_robot_queue_frames", "Its sweeps that are not fully sent",
      [](const R& r) { return std::optional(r.queued_frames); });
  add("sweepcast_robot_queue_bytes", "Bytes of them",
      [](const R& r) { return std::optional(r.queued_bytes); });
  add("sweepcast_robot_sweeps_total", "Sweeps that it had to send",
      [](const R& r) { return std::optional(r.sweeps); });
  add("sweepcast_robot_sweeps_dropped_total", "Sweeps that it dropped",
      [](const R& r) { return std::optional(r.dropped); });
  add("sweepcast_robot_qoe", "Mean QoE of its last sweeps", [](const R& r) { return r.qoe; });
  return metrics;
}

/// What the senders of all robots told last.
nlohmann::ordered_json json_of(const std::vector<RobotStatus>& robots) {
  const auto or_null = [](const auto& value) {
    return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
  };
  auto out = nlohmann::ordered_json::object();
  for (const RobotStatus& robot : robots) {
    out[robot.robot] = nullptr;
    if (!robot.report) continue;
    const SenderReport& r = *robot.report;
    out[robot.robot] = {{"level", or_null(r.level)},
                        {"override", or_null(r.override_level)},
                        {"queue_frames", r.queued_frames},
                        {"queue_bytes", r.queued_bytes},
                        {"sweeps", r.sweeps},
                        {"sent", r.sent},
                        {"cut", r.cut},
                        {"dropped", r.dropped},
                        {"qoe", or_null(r.qoe)}};
  }
  return out;
}

void report(const ReceiverStatus& s, const Arrivals::Figures& f,
            const std::vector<RobotStatus>& robots, bool json) {
  if (json) {
    nlohmann::ordered_json out;
    for (const Metric& metric : metrics_of(s, f)) {
      constexpr std::size_t kPrefix = sizeof("sweepcast_") - 1;
      out[metric.name.substr(kPrefix)] = metric.value;
    }
    out["robots"] = json_of(robots);
    print_json(out);
    return;
  }
  fmt::print(stderr, "{} sweeps whole, {} cut, {} missed; {} bytes\n", s.sweeps_whole, s.sweeps_cut,
             s.sweeps_missed, f.bytes);
}

/// [ADDRESS:]PORT; false where it is neither.
bool read_address(const std::string& text, std::string& address, std::uint16_t& port) {
  const std::size_t colon = text.rfind(':');
  const std::string digits = colon == std::string::npos ? text : text.substr(colon + 1);
  const bool is_sound = !digits.empty() && digits.size() <= 5 &&
                        digits.find_first_not_of("0123456789") == std::string::npos &&
                        std::stoi(digits) <= 65535;
  if (!is_sound) return false;
  port = static_cast<std::uint16_t>(std::stoi(digits));
  if (colon != std::string::npos) address = text.substr(0, colon);
  return true;
}

/// Nothing where nobody asked for it.
Result<std::optional<view::Server>> start_viewer(ReceiveOptions& options) {
  if (options.view.empty()) return std::nullopt;
  options.viewer.title = "live";
  auto server = view::Server::start(options.viewer, nullptr);
  if (!server) return tl::unexpected(server.error());
  print_note("viewing at " + server->url());
  return std::move(*server);
}

void show(view::Server& server, const ReceivedSweep& sweep) {
  server.publish({sweep.robot, sweep.sensor, sweep.name, sweep.frame, sweep.age_s});
}

/// Tells who views what the senders tell, and the senders what those who view ask for.
void mediate(view::Server& server, Receiver& receiver) {
  server.tell(receiver.robots());
  for (const view::LevelWish& wish : server.take_wishes()) {
    // Refused where the robot has just gone; the page sees that it does not obey.
    (void)receiver.ask_level(wish.robot, wish.level);
  }
}

Status receive(ReceiveOptions& options) {
  stop_on_signals();  // before anything is written
  auto keys = read_link_keys(options.keys_file);
  if (!keys) return tl::unexpected(keys.error());
  options.receiver.keys = std::move(*keys);
  auto store = SweepStore::open(options.output);
  if (!store) return tl::unexpected(store.error());
  Arrivals arrivals(std::move(*store));
  auto viewer = start_viewer(options);
  if (!viewer) return tl::unexpected(viewer.error());
  options.receiver.on_sweep = [&](const ReceivedSweep& sweep) {
    arrivals.take(sweep);
    if (*viewer) show(**viewer, sweep);
  };
  auto started = Receiver::start(options.receiver);
  if (!started) return tl::unexpected(started.error());
  std::optional<Receiver> receiver = std::move(*started);
  std::optional<MetricsServer> server;
  if (!options.metrics.empty()) {
    auto serving = MetricsServer::start(metrics_address(options.metrics), [&] {
      auto metrics = metrics_of(receiver->status(), arrivals.figures());
      for (Metric& metric : metrics_of(receiver->robots())) metrics.push_back(std::move(metric));
      return metrics;
    });
    if (!serving) return tl::unexpected(serving.error());
    server = std::move(*serving);
  }
  print_note(fmt::format("listening at {}:{}", options.receiver.address, receiver->port()));
  constexpr std::chrono::milliseconds kInterval{200};
  {
    StatusLine line;
    while (!wait_for_stop(std::chrono::steady_clock::now() + kInterval)) {
      if (*viewer) mediate(**viewer, *receiver);
      line.update([&] {
        const ReceiverStatus s = receiver->status();
        return fmt::format("{} robots, {} sweeps whole, {} cut, {} missed, age {:.0f} ms  {}",
                           s.peers, s.sweeps_whole, s.sweeps_cut, s.sweeps_missed,
                           s.newest_age_s * 1e3, arrivals.figures().last);
      });
    }
  }
  server.reset();
  const ReceiverStatus last = receiver->status();
  const std::vector<RobotStatus> robots = receiver->robots();
  receiver.reset();
  report(last, arrivals.figures(), robots, options.json && options.output != "-");
  return arrivals.close();
}

}  // namespace

void add_receive(CLI::App& app, Command& command) {
  auto options = std::make_shared<ReceiveOptions>();
  CLI::App* sub = app.add_subcommand("receive", "Receive sweeps from robots");
  sub->add_option_function<std::string>(
         "--listen",
         [options](const std::string& text) {
           if (!read_address(text, options->receiver.address, options->receiver.port)) {
             throw CLI::ValidationError("--listen", text + " is not [ADDRESS:]PORT");
           }
         },
         "Where robots find us [127.0.0.1:PORT]; 0.0.0.0:PORT is every interface")
      ->type_name("[ADDRESS:]PORT")
      ->required();
  sub->add_option("--keys", options->keys_file, "The robots' keys, see keygen")
      ->type_name("FILE")
      ->required();
  sub->add_option("-o,--output", options->output,
                  "A .sweep file, a folder for robot/sensor.sweep, or - for standard output")
      ->type_name("OUT.sweep|DIR|-")
      ->required();
  sub->add_option("--metrics", options->metrics, "Serve Prometheus text at /metrics")
      ->type_name("[HOST:]PORT");
  sub->add_option_function<std::string>(
         "--view",
         [options](const std::string& text) {
           options->view = text;
           if (!read_address(text, options->viewer.address, options->viewer.port)) {
             throw CLI::ValidationError("--view", text + " is not [ADDRESS:]PORT");
           }
         },
         "Show the sweeps in the browser and in Foxglove, at [127.0.0.1:PORT]")
      ->type_name("[ADDRESS:]PORT");
  sub->add_option("--view-token", options->viewer.token,
                  "Who views needs it: ?token=TOKEN; has to be at other addresses")
      ->type_name("TOKEN");
  sub->add_flag("--json", options->json, "Print the outcome as JSON; not with -o -");
  sub->footer("Example: sweepcast receive --listen 0.0.0.0:5600 --keys robots.keys -o received");
  sub->callback([options, &command] { command = [options] { return receive(*options); }; });
}

}  // namespace sweepcast::app
