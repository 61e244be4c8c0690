// Checks of single values on the command line.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace sweepcast::app {

/// Takes a number from `min` to `max`; not NaN, which CLI::Range lets pass.
[[nodiscard]] CLI::Validator number_between(double min, double max);

/// Takes 0 to 2^64 - 1; CLI11's own conversion wraps what is negative and caps what is larger.
[[nodiscard]] CLI::Validator whole_number();

/// Takes one of these words, as an item of a list that commas separate.
[[nodiscard]] CLI::Validator items_of(const std::vector<std::string>& words);

}  // namespace sweepcast::app
