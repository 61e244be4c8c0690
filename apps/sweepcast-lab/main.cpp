#include <cstdio>
#include <exception>

#include "sweepcast-lab/commands.hpp"

int main(int argc, char** argv) try {
  // Named as the user called it: `sweepcast` hands these subcommands over.
  CLI::App app{"Simulates drives and measures codecs.", "sweepcast"};
  app.require_subcommand(1);
  sweepcast::app::Command command;
  sweepcast::app::add_simulate(app, command);
  sweepcast::app::add_simulate_link(app, command);
  sweepcast::app::add_bench(app, command);
  sweepcast::app::add_ablate(app, command);
  sweepcast::app::add_evaluate(app, command);
  sweepcast::app::add_odometry(app, command);
  sweepcast::app::add_mesh(app, command);
  sweepcast::app::add_detect(app, command);
  sweepcast::app::add_train_detector(app, command);
  return sweepcast::app::run(app, command, argc, argv);
} catch (const std::exception& error) {  // memory ran out before there was a command to blame
  std::fputs(error.what(), stderr);
  return 1;
}
