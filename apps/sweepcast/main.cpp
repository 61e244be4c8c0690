#include <fmt/core.h>
#include <zstd.h>

#include <cstdio>
#include <exception>

#include "common/build_info.hpp"
#include "sweepcast/commands.hpp"

namespace {

using namespace sweepcast::app;

int run_tool(int argc, char** argv) {
  CLI::App app{"Compresses LiDAR sweeps, gives them back, and measures what was lost.",
               "sweepcast"};
  app.set_version_flag("--version", [] {
    return fmt::format("sweepcast {}\ncomponents: {}\nzstd: {}", kVersion, kComponents,
                       ZSTD_versionString());
  });
  app.footer(
      "Example: sweepcast encode drive/sweeps -o drive.sweep\n"
      "Each command has its own help, as in `sweepcast encode --help`.");
  app.require_subcommand(1);
  Command command;
  add_encode(app, command);
  add_decode(app, command);
  add_info(app, command);
  add_verify(app, command);
  add_compare(app, command);
  add_calibrate(app, command);
  add_keygen(app, command);
  add_send(app, command);
  add_receive(app, command);
  add_view(app, command);
  add_emulate_link(app, command);
  add_lab(app);
  return run(app, command, argc, argv);
}

}  // namespace

int main(int argc, char** argv) try {
  return argc > 1 && is_lab_command(argv[1]) ? run_lab(argv) : run_tool(argc, argv);
} catch (const std::exception& error) {  // memory ran out before there was a command to blame
  std::fputs(error.what(), stderr);
  return 1;
}
