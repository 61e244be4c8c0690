// What every subcommand of the tools shares.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "sweepcast/status.hpp"

namespace sweepcast::app {

/// What the command line asked for; set by the chosen subcommand, run once after parsing.
using Command = std::function<Status()>;

/// Runs a program: parses, runs the command, prints "PROGRAM: error: ..." to standard error.
/// Where no argument follows the program's or a subcommand's name, prints the help instead.
/// Returns the exit status: 0, 1 where the work failed or standard output could not take the
/// result, 2 where the command line is wrong.
[[nodiscard]] int run(CLI::App& app, const Command& command, int argc, char** argv);

/// Prints "sweepcast: error: MESSAGE" to standard error, for a command that goes on after it.
void print_error(std::string_view message);

/// Prints "sweepcast: warning: MESSAGE" to standard error: done as told, but hardly as meant.
void print_warning(std::string_view message);

/// Prints "sweepcast: note: MESSAGE" to standard error: worth knowing, but no failure.
void print_note(std::string_view message);

/// Prints a value to standard output, indented, and a line's end. Bytes that are not UTF-8, as a
/// file's name may have, become U+FFFD.
void print_json(const nlohmann::ordered_json& value);

}  // namespace sweepcast::app
