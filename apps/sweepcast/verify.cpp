#include "sweepcast/commands.hpp"

namespace sweepcast::app {

void add_verify(CLI::App& /*app*/, Command& /*command*/) {}

}  // namespace sweepcast::app
