// The subcommands of `sweepcast`, one file each. Every function adds one to the program and sets
// `command` when it is chosen.
#pragma once

#include "common/command.hpp"

namespace sweepcast::app {

void add_encode(CLI::App& app, Command& command);
void add_decode(CLI::App& app, Command& command);
void add_info(CLI::App& app, Command& command);
void add_verify(CLI::App& app, Command& command);
void add_compare(CLI::App& app, Command& command);
/// simulate, bench, ablate: run by `sweepcast-lab`, see lab.cpp.
void add_lab(CLI::App& app, Command& command);

}  // namespace sweepcast::app
