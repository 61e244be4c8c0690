// The octree codec of the Point Cloud Library.
#pragma once

#include "lab/peers/peer.hpp"

namespace sweepcast::lab {

struct PclOctreeOptions {
  double step_m = 0.05;  ///< edge of the octree's leaves
};

/// Makes the codec "pcl-octree"; setting "step 0.05 m". Points in one leaf become its centre (PCL's
/// "voxel grid"). Every sweep is coded by itself. The library's decoder trusts its input, so each
/// frame has a checksum of 4 bytes.
/// Errors: invalid_argument (step outside 1 mm to 100 m), unsupported (this build has no PCL).
[[nodiscard]] Result<std::unique_ptr<Peer>> make_pcl_octree_peer(const PclOctreeOptions& options);

/// From a ratio of about 10 to 400. Errors: unsupported.
[[nodiscard]] Result<Peers> pcl_octree_ladder();

}  // namespace sweepcast::lab
