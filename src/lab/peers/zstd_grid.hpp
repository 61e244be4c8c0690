// The simplest that a user could build: coordinates on a grid, differences, zstd.
#pragma once

#include <cstdint>

#include "lab/peers/peer.hpp"

namespace sweepcast::lab {

/// In which order the points are coded.
enum class GridOrder : std::uint8_t {
  as_given,  ///< differences from point to point, a column of their bytes for each axis
  morton,    ///< along a Morton curve, differences as varints; points in one cell become one
};

struct ZstdGridOptions {
  double step_m = 0.02;
  GridOrder order = GridOrder::morton;
  int level = 19;  ///< of zstd
};

/// Makes the codec "zstd-delta" or "zstd-morton"; setting "step 0.02 m".
/// Errors: invalid_argument (step outside 1 um to 100 m, level outside 1 to 22).
[[nodiscard]] Result<std::unique_ptr<Peer>> make_zstd_grid_peer(const ZstdGridOptions& options);

/// Morton order, from a ratio of about 10 to 400. Without errors.
[[nodiscard]] Result<Peers> zstd_morton_ladder();
/// The order given, from a ratio of about 10 to 130: coarser steps (this one is 1.6 m) gain little.
[[nodiscard]] Result<Peers> zstd_delta_ladder();

}  // namespace sweepcast::lab
