// Stands in for jpegls.cpp where the library was not found.
#include "lab/peers/jpegls.hpp"

namespace sweepcast::lab {
namespace {

tl::unexpected<Error> absent() {
  return fail(ErrorCode::unsupported,
              "jpegls: this build was made without CharLS; apt-get install libcharls-dev, then "
              "configure and build again");
}

}  // namespace

Result<std::unique_ptr<Peer>> make_jpegls_peer(const JpeglsOptions& /*options*/) {
  return absent();
}

Result<Peers> jpegls_ladder() {
  return absent();
}

}  // namespace sweepcast::lab
