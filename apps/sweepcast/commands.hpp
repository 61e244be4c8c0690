// The subcommands of `sweepcast`, one file each. Every function adds one to the program and sets
// `command` when it is chosen.
#pragma once

#include <string>

#include "common/command.hpp"

namespace sweepcast::app {

void add_encode(CLI::App& app, Command& command);
void add_decode(CLI::App& app, Command& command);
void add_info(CLI::App& app, Command& command);
void add_verify(CLI::App& app, Command& command);
void add_compare(CLI::App& app, Command& command);
void add_calibrate(CLI::App& app, Command& command);
void add_keygen(CLI::App& app, Command& command);
void add_send(CLI::App& app, Command& command);
void add_receive(CLI::App& app, Command& command);
void add_view(CLI::App& app, Command& command);
void add_emulate_link(CLI::App& app, Command& command);

/// Lists simulate, bench and ablate in the help; `run_lab` runs them.
void add_lab(CLI::App& app);
/// True for the name of a subcommand that `sweepcast-lab` has.
[[nodiscard]] bool is_lab_command(const std::string& word);
/// Becomes `sweepcast-lab` with the same arguments, untouched. Returns, with the exit status, only
/// where that program is absent or cannot run, after saying so.
[[nodiscard]] int run_lab(char** argv);

}  // namespace sweepcast::app
