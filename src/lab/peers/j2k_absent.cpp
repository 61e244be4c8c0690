// Stands in for j2k.cpp where the library was not found.
#include "lab/peers/j2k.hpp"

namespace sweepcast::lab {
namespace {

tl::unexpected<Error> absent() {
  return fail(ErrorCode::unsupported,
              "j2k: this build was made without OpenJPEG; apt-get install libopenjp2-7-dev, then "
              "configure and build again");
}

}  // namespace

Result<std::unique_ptr<Peer>> make_j2k_peer(const J2kOptions& /*options*/) {
  return absent();
}

Result<Peers> j2k_ladder() {
  return absent();
}

Result<Peers> j2k_naive_ladder() {
  return absent();
}

}  // namespace sweepcast::lab
