// The subcommands of `sweepcast-lab`, one file each: what needs heavy libraries.
#pragma once

#include "common/command.hpp"

namespace sweepcast::app {

void add_simulate(CLI::App& app, Command& command);
void add_simulate_link(CLI::App& app, Command& command);
void add_bench(CLI::App& app, Command& command);
void add_ablate(CLI::App& app, Command& command);
void add_evaluate(CLI::App& app, Command& command);
void add_odometry(CLI::App& app, Command& command);
void add_mesh(CLI::App& app, Command& command);
void add_detect(CLI::App& app, Command& command);
void add_train_detector(CLI::App& app, Command& command);

}  // namespace sweepcast::app
