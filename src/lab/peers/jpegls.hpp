// JPEG-LS on range images, by CharLS: the classic near-lossless codec of pictures.
#pragma once

#include "lab/peers/peer.hpp"
#include "lab/peers/range_image_peer.hpp"

namespace sweepcast::lab {

struct JpeglsOptions {
  RangeImageForm form{};
  int near = 25;  ///< largest error of a pixel, in steps of range (2 mm, see `draw`)
};

/// Makes the codec "jpegls-range"; setting "beams x 2048, near 25". Only the beam-aligned form.
/// Errors: invalid_argument (near outside 0 to 255, columns, form), unsupported (this build has no
/// CharLS).
[[nodiscard]] Result<std::unique_ptr<Peer>> make_jpegls_peer(const JpeglsOptions& options);

/// From a ratio of about 10 to 400 on a sensor of 64 beams. Errors: unsupported.
[[nodiscard]] Result<Peers> jpegls_ladder();

}  // namespace sweepcast::lab
