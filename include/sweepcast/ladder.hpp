// The quality ladder: numbered settings of a codec, finest first.
#pragma once

#include <array>

namespace sweepcast {

/// The four parameters of the RCPCC paper, in the paper's order (section IV.A).
struct RcpccParams {
  double azimuth_step_deg = 0.5;    ///< delta theta: width of a cell, degrees, 0.05 to 10
  double elevation_step_deg = 0.5;  ///< delta phi: height of a cell, degrees, 0.05 to 10
  double threshold_m = 0.3;         ///< delta r: largest range error on a fitted surface, metres
  double quantiser_step_m = 0.2;    ///< q_step: quantiser step of the SA-DCT coefficients, metres

  [[nodiscard]] bool operator==(const RcpccParams&) const = default;
};

/// Levels 0 (finest) to 5 of the code that the paper's authors released.
inline constexpr std::array<RcpccParams, 6> kRcpccLevels{{
    {0.5, 0.25, 0.1, 0.1},
    {0.5, 0.25, 0.2, 0.2},
    {0.5, 0.25, 0.4, 0.2},
    {1.0, 0.5, 0.1, 0.2},
    {1.0, 0.5, 0.2, 0.2},
    {2.0, 1.0, 0.4, 0.2},
}};

}  // namespace sweepcast
