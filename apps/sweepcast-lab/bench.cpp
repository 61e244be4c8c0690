#include "sweepcast-lab/commands.hpp"

namespace sweepcast::app {

void add_bench(CLI::App& /*app*/, Command& /*command*/) {}

}  // namespace sweepcast::app
