// Stands in for draco.cpp where the library was not found.
#include "lab/peers/draco.hpp"

namespace sweepcast::lab {
namespace {

tl::unexpected<Error> absent() {
  return fail(ErrorCode::unsupported,
              "draco: this build was made without it; apt-get install libdraco-dev, then configure "
              "and build again");
}

}  // namespace

Result<std::unique_ptr<Peer>> make_draco_peer(const DracoOptions& /*options*/) {
  return absent();
}

Result<Peers> draco_ladder() {
  return absent();
}

double draco_worst_error(const PointCloud& /*cloud*/, double /*step_m*/) {
  return 0.0;
}

Result<double> coarsest_draco_step(std::span<const PointCloud> /*clouds*/, double /*max_error_m*/) {
  return absent();
}

}  // namespace sweepcast::lab
