// Runs another program and waits for it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// Whether a program of this name is on the PATH, or, where it has a slash, at this path.
[[nodiscard]] bool has_program(const std::string& name);

/// Runs `arguments[0]`, searched for on the PATH, without a shell and without input; what it prints
/// goes to the file `log`. Gives the CPU time that it took, milliseconds. A program that takes over
/// ten minutes of it is ended.
/// Errors: not_found (no such program), io (it cannot be run, or did not end well; with its last
/// line).
[[nodiscard]] Result<double> run_program(const std::vector<std::string>& arguments,
                                         const std::filesystem::path& log);

}  // namespace sweepcast::lab
