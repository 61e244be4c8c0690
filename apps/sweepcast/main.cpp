#include "sweepcast/commands.hpp"

int main(int argc, char** argv) {
  CLI::App app{"Compresses LiDAR sweeps, gives them back, and measures what was lost.",
               "sweepcast"};
  app.require_subcommand(1);
  sweepcast::app::Command command;
  sweepcast::app::add_encode(app, command);
  sweepcast::app::add_decode(app, command);
  sweepcast::app::add_info(app, command);
  sweepcast::app::add_verify(app, command);
  sweepcast::app::add_compare(app, command);
  sweepcast::app::add_lab(app, command);
  return sweepcast::app::run(app, command, argc, argv);
}
