// What every subcommand of the tools shares.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "sweepcast/status.hpp"

namespace sweepcast::app {

/// What the command line asked for; set by the chosen subcommand, run once after parsing.
using Command = std::function<Status()>;

/// Runs a program: parses, runs the command, prints "PROGRAM: error: ..." to standard error.
/// Returns the exit status: 0, 1 where the work failed, 2 where the command line is wrong.
[[nodiscard]] int run(CLI::App& app, const Command& command, int argc, char** argv);

}  // namespace sweepcast::app
