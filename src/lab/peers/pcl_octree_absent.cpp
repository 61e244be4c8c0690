// Stands in for pcl_octree.cpp where the library was not found.
#include "lab/peers/pcl_octree.hpp"

namespace sweepcast::lab {
namespace {

tl::unexpected<Error> absent() {
  return fail(ErrorCode::unsupported,
              "pcl: this build was made without it; apt-get install libpcl-dev (1.1 GB), then "
              "configure and build again");
}

}  // namespace

Result<std::unique_ptr<Peer>> make_pcl_octree_peer(const PclOctreeOptions& /*options*/) {
  return absent();
}

Result<Peers> pcl_octree_ladder() {
  return absent();
}

}  // namespace sweepcast::lab
