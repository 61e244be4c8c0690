#include "sweepcast/commands.hpp"

namespace sweepcast::app {

void add_encode(CLI::App& /*app*/, Command& /*command*/) {}

}  // namespace sweepcast::app
