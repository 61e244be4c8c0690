// `sweepcast emulate-link`: a bad link on this machine.
#include <fmt/core.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "common/interruption.hpp"
#include "common/validators.hpp"
#include "link/relay.hpp"
#include "link/trace.hpp"
#include "sweepcast/commands.hpp"

namespace sweepcast::app {
namespace {

struct EmulateOptions {
  RelayOptions relay;
  std::string trace;
  double delay_ms = 0.0;
  double jitter_ms = 0.0;
  double loss_percent = 0.0;
  double reordering_percent = 0.0;
  bool json = false;
};

std::int64_t microseconds(double milliseconds) {
  return std::llround(milliseconds * 1e3);
}

Status emulate(EmulateOptions& options) {
  auto trace = read_trace(options.trace);
  if (!trace) return tl::unexpected(trace.error());
  options.relay.trace = std::move(*trace);
  options.relay.link.delay_us = microseconds(options.delay_ms);
  options.relay.link.jitter_us = microseconds(options.jitter_ms);
  options.relay.link.loss = options.loss_percent / 100.0;
  options.relay.link.reordering = options.reordering_percent / 100.0;
  const auto relay = Relay::start(options.relay);
  if (!relay) return tl::unexpected(relay.error());
  stop_on_signals();
  print_note(fmt::format("relaying {}:{} to {}:{}", options.relay.listen_address, relay->port(),
                         options.relay.to_address, options.relay.to_port));
  constexpr std::chrono::hours kLong{1};
  while (!wait_for_stop(std::chrono::steady_clock::now() + kLong)) {
  }
  const RelayCounts counts = relay->counts();
  if (options.json) {
    print_json({{"packets_in", counts.packets_in},
                {"bytes_in", counts.bytes_in},
                {"packets_out", counts.packets_out},
                {"bytes_out", counts.bytes_out},
                {"lost", counts.lost},
                {"queue_lost", counts.queue_lost},
                {"packets_back", counts.packets_back}});
    return {};
  }
  fmt::print("{} packets in, {} out; {} lost by chance, {} for want of room; {} back\n",
             counts.packets_in, counts.packets_out, counts.lost, counts.queue_lost,
             counts.packets_back);
  return {};
}

/// Reads "[ADDRESS:]PORT".
void parse_endpoint(const std::string& option, const std::string& text, std::string& address,
                    std::uint16_t& port) {
  const std::size_t colon = text.rfind(':');
  const std::string digits = colon == std::string::npos ? text : text.substr(colon + 1);
  const bool sound = !digits.empty() && digits.size() <= 5 &&
                     digits.find_first_not_of("0123456789") == std::string::npos &&
                     std::stoi(digits) <= 65535;
  if (!sound) throw CLI::ValidationError(option, text + " is not [ADDRESS:]PORT");
  port = static_cast<std::uint16_t>(std::stoi(digits));
  if (colon != std::string::npos) address = text.substr(0, colon);
}

}  // namespace

void add_emulate_link(CLI::App& app, Command& command) {
  auto options = std::make_shared<EmulateOptions>();
  RelayOptions& relay = options->relay;
  CLI::App* sub =
      app.add_subcommand("emulate-link", "Relay UDP packets as a slow, late and lossy link would");
  sub->add_option_function<std::string>(
         "--listen",
         [&relay](const std::string& text) {
           parse_endpoint("--listen", text, relay.listen_address, relay.listen_port);
         },
         "Where clients send to; 127.0.0.1 unless an address is given")
      ->type_name("[ADDRESS:]PORT")
      ->required();
  sub->add_option_function<std::string>(
         "--to",
         [&relay](const std::string& text) {
           parse_endpoint("--to", text, relay.to_address, relay.to_port);
         },
         "The server to relay to")
      ->type_name("[ADDRESS:]PORT")
      ->required();
  sub->add_option("--trace", options->trace,
                  "What clients may send: a mahimahi trace, a .schedule, or \"paper\"")
      ->type_name("FILE|paper")
      ->required();
  sub->add_option("--delay", options->delay_ms, "One way, both ways [0]")
      ->check(number_between(0, 60'000))
      ->type_name("MS");
  sub->add_option("--jitter", options->jitter_ms, "Further delay, from 0 to this [0]")
      ->check(number_between(0, 60'000))
      ->type_name("MS");
  sub->add_option("--loss", options->loss_percent, "Packets that are lost [0]")
      ->check(number_between(0, 100))
      ->type_name("PERCENT");
  sub->add_option("--reorder", options->reordering_percent, "Packets that others overtake [0]")
      ->check(number_between(0, 100))
      ->type_name("PERCENT");
  sub->add_option("--queue-limit", relay.link.queue_limit, "Room for what waits; 0: no limit [0]")
      ->check(whole_number())
      ->type_name("BYTES");
  sub->add_option("--seed", relay.link.seed, "Of what is left to chance [1]")
      ->check(whole_number())
      ->type_name("N");
  sub->add_flag("--json", options->json, "Print the outcome as JSON");
  sub->footer(
      "Example: sweepcast emulate-link --listen 5601 --to 5600 --trace paper --delay 30 --loss 2");
  sub->callback([options, &command] { command = [options] { return emulate(*options); }; });
}

}  // namespace sweepcast::app
