#include "sweepcast/commands.hpp"

namespace sweepcast::app {

void add_decode(CLI::App& /*app*/, Command& /*command*/) {}

}  // namespace sweepcast::app
