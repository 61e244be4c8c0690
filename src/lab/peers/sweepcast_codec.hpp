// Our own codecs, measured like any other.
#pragma once

#include <memory>
#include <string>

#include "lab/peers/peer.hpp"
#include "sweepcast/decoder.hpp"
#include "sweepcast/encoder.hpp"

namespace sweepcast::lab {

/// Makes a peer of an `Encoder` and a `Decoder` with these options. `setting` is its label.
/// Only coordinates are coded, whatever the options say: peers are compared by geometry.
/// Errors: invalid_argument, see `Encoder::create`.
[[nodiscard]] Result<std::unique_ptr<Peer>> make_sweepcast_peer(const EncoderOptions& options,
                                                                std::string setting,
                                                                const DecoderOptions& decoder = {});

}  // namespace sweepcast::lab
