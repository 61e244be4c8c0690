// MPEG's G-PCC, octree geometry, by its test model's program `tmc3`: ours to call, not to ship.
#pragma once

#include <string>
#include <vector>

#include "lab/peers/peer.hpp"

namespace sweepcast::lab {

struct GpccOptions {
  double step_m = 0.05;          ///< edge of the octree's leaves
  std::string program = "tmc3";  ///< a name on the PATH, or a path
};

/// Makes the codec "gpcc-octree"; setting "step 0.05 m". Points in one leaf become one. Every sweep
/// is written to a temporary PLY file of whole steps, which the program reads; decoding is the
/// same backwards. `child_ms` has the program's CPU time, its reading and writing of PLY among it.
/// Errors: invalid_argument (step outside 1 um to 100 m), not_found (no such program).
[[nodiscard]] Result<std::unique_ptr<Peer>> make_gpcc_peer(const GpccOptions& options);

/// From a ratio of about 10 to 400. Errors: not_found.
[[nodiscard]] Result<Peers> gpcc_ladder();

}  // namespace sweepcast::lab
