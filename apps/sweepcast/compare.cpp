#include "sweepcast/commands.hpp"

namespace sweepcast::app {

void add_compare(CLI::App& /*app*/, Command& /*command*/) {}

}  // namespace sweepcast::app
