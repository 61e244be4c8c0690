// Stands in for draco.cpp where the library was not found.
#include "lab/peers/draco.hpp"

namespace sweepcast::lab {

Result<std::unique_ptr<Peer>> make_draco_peer(const DracoOptions& /*options*/) {
  return fail(ErrorCode::unsupported,
              "draco: this build was made without it; apt-get install libdraco-dev, then configure "
              "and build again");
}

}  // namespace sweepcast::lab
