// Codec beam at a ratio.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "lab/peers/peer.hpp"
#include "sweepcast/cloud.hpp"

namespace sweepcast::lab {

/// Makes a peer "beam", setting "ratio 100", or "beam-fill" where the decoder fills in what was
/// left out (`DecoderOptions::fill`), that codes a drive of `sweeps` sweeps, the first of which is
/// `first`, at this ratio or little above: 16 bytes for each point that comes in over all bytes,
/// the sensor's model among them. Each frame has a budget in proportion to its points; what one
/// leaves the next may use. To be fed the whole drive in order. Errors of making: invalid_argument
/// (a ratio below 1, no sweep, or one that leaves no byte beside the sensor's model), the
/// encoder's. Of encoding: limit, where no quality is small enough.
[[nodiscard]] Result<std::unique_ptr<Peer>> make_aimed_beam(double ratio, const PointCloud& first,
                                                            std::size_t sweeps, bool fill = false);

}  // namespace sweepcast::lab
