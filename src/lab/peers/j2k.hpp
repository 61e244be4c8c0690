// JPEG 2000 on range images, by OpenJPEG.
#pragma once

#include "lab/peers/peer.hpp"
#include "lab/peers/range_image_peer.hpp"

namespace sweepcast::lab {

struct J2kOptions {
  RangeImageForm form{};
  /// Bytes of the picture (2 a pixel) over those that it may take; the mask comes on top.
  double rate = 8.0;
};

/// Makes the codec "j2k-range", or "j2k-range-naive" where the form is not beam-aligned; setting
/// "beams x 2048, rate 8".
/// Errors: invalid_argument (rate outside 1 to 1000, columns), unsupported (this build has no
/// OpenJPEG).
[[nodiscard]] Result<std::unique_ptr<Peer>> make_j2k_peer(const J2kOptions& options);

/// From a ratio of about 10 to 400 on a sensor of 64 beams. Errors: unsupported.
[[nodiscard]] Result<Peers> j2k_ladder();
[[nodiscard]] Result<Peers> j2k_naive_ladder();

}  // namespace sweepcast::lab
