// Google's Draco, the codec that comes closest in speed: its kd-tree coder for point clouds.
#pragma once

#include "lab/peers/peer.hpp"

namespace sweepcast::lab {

/// A setting of Draco's kd-tree.
struct DracoOptions {
  int quantisation_bits = 11;  ///< "qp": bits of a coordinate over the cloud's largest extent
  int compression_level = 7;   ///< "cl", 0 to 10: Draco's speed is 10 less this
};

/// Makes the codec "draco-kd", setting "qp11 cl7"; it codes the finite points' coordinates.
/// Errors: invalid_argument (bits outside 1 to 30, level outside 0 to 10), unsupported (this build
/// has no Draco).
[[nodiscard]] Result<std::unique_ptr<Peer>> make_draco_peer(const DracoOptions& options);

}  // namespace sweepcast::lab
