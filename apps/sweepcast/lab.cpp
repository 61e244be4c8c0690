#include "sweepcast/commands.hpp"

namespace sweepcast::app {

void add_lab(CLI::App& /*app*/, Command& /*command*/) {}

}  // namespace sweepcast::app
