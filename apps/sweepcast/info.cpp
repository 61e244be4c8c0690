#include "sweepcast/commands.hpp"

namespace sweepcast::app {

void add_info(CLI::App& /*app*/, Command& /*command*/) {}

}  // namespace sweepcast::app
