// `sweepcast view`: recordings in the browser, and in Foxglove.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "common/inputs.hpp"
#include "common/interruption.hpp"
#include "common/validators.hpp"
#include "sweepcast/commands.hpp"
#include "view/recording.hpp"
#include "view/server.hpp"

namespace sweepcast::app {
namespace {

namespace fs = std::filesystem;

struct ViewOptions {
  std::string input;
  std::string originals;
  double max_error_m = 0.01;
  view::ServerOptions server;
};

/// The .sweep files that INPUT stands for, those of a folder's folders too; none for clouds.
Result<std::vector<fs::path>> sweep_files(const fs::path& input) {
  std::vector<fs::path> files;
  std::error_code error;
  if (!fs::is_directory(input, error)) {
    if (input.extension() == ".sweep") files.push_back(input);
    return files;
  }
  constexpr int kDeepest = 3;
  fs::recursive_directory_iterator at(input, error);
  for (const fs::recursive_directory_iterator end; !error && at != end; at.increment(error)) {
    if (at.depth() >= kDeepest) at.disable_recursion_pending();
    if (at->path().extension() == ".sweep" && at->is_regular_file()) files.push_back(at->path());
  }
  if (error) {
    return fail(ErrorCode::io, input.string() + ": cannot be listed (" + error.message() +
                                   "); check its permissions");
  }
  std::sort(files.begin(), files.end());
  return files;
}

Result<std::unique_ptr<view::Recording>> open_recording(const ViewOptions& options) {
  auto files = sweep_files(options.input);
  if (!files) return tl::unexpected(files.error());
  if (!files->empty()) {
    std::vector<fs::path> originals;
    if (!options.originals.empty()) {
      auto clouds = collect_clouds({options.originals});
      if (!clouds) return tl::unexpected(clouds.error());
      originals = std::move(*clouds);
    }
    return view::open_sweep_files(*files, originals);
  }
  auto clouds = collect_clouds({options.input});
  if (!clouds) return tl::unexpected(clouds.error());
  if (!options.originals.empty()) {
    return fail(ErrorCode::invalid_argument,
                options.input + ": clouds are their own originals; leave --original out");
  }
  print_note(fmt::format("{}: clouds, encoded as they are shown, within {} m; see --max-error",
                         options.input, options.max_error_m));
  EncoderOptions encoder;
  encoder.beam.max_error_m = options.max_error_m;
  encoder.beam.effort = Effort::fast;
  return view::open_clouds(std::move(*clouds), encoder, options.server.rate_hz);
}

Status view_recording(const ViewOptions& options) {
  stop_on_signals();
  auto recording = open_recording(options);
  if (!recording) return tl::unexpected(recording.error());
  auto server = view::Server::start(options.server, std::move(*recording));
  if (!server) return tl::unexpected(server.error());
  fmt::print("{}\n", server->url());
  std::fflush(stdout);  // whoever waits for the line reads a pipe
  constexpr std::chrono::hours kInterval{1};
  while (!wait_for_stop(std::chrono::steady_clock::now() + kInterval)) {
  }
  return {};
}

}  // namespace

void add_view(CLI::App& app, Command& command) {
  auto options = std::make_shared<ViewOptions>();
  options->server.port = 8080;
  CLI::App* sub = app.add_subcommand("view", "Show sweeps in the browser and in Foxglove");
  sub->add_option("input", options->input,
                  "A .sweep file, a folder of them, or a cloud or folder of clouds")
      ->type_name("INPUT")
      ->required();
  sub->add_option("--port", options->server.port, "Where the page is [8080]; 0: any free port")
      ->type_name("PORT");
  sub->add_option("--address", options->server.address,
                  "Where to listen [127.0.0.1]; others than the loopback need --token")
      ->type_name("ADDRESS");
  sub->add_option("--token", options->server.token, "Every request needs it: ?token=TOKEN")
      ->type_name("TOKEN");
  sub->add_option("--origin", options->server.origins,
                  "A further page that may connect, as https://lichtblick.example")
      ->type_name("ORIGIN")
      ->allow_extra_args(false);
  sub->add_option("--original", options->originals,
                  "The clouds that a .sweep file was made from, to compare with")
      ->type_name("DIR");
  sub->add_option("--max-error", options->max_error_m, "Of clouds, metres [0.01]")
      ->type_name("METRES")
      ->check(number_between(0.001, 2.0));
  sub->add_option("--rate", options->server.rate_hz, "Sweeps a second [10]")
      ->type_name("HZ")
      ->check(number_between(0.1, 1000.0));
  sub->footer("Example: sweepcast view drive.sweep --original drive/sweeps");
  sub->callback([options, &command] {
    command = [options] {
      options->server.title = fs::path(options->input).filename().string();
      if (options->server.title.empty()) options->server.title = options->input;
      return view_recording(*options);
    };
  });
}

}  // namespace sweepcast::app
