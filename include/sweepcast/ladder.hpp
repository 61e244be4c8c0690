// The quality ladder: numbered settings of a codec, finest first.
#pragma once

#include <array>
#include <cstddef>

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

/// How codec `beam` codes a sweep's five layers, coarsest first.
struct BeamQuality {
  static constexpr std::size_t kLayers = 5;
  /// Steps of ranges, metres: points that are kept decode within half of it along their beam.
  std::array<double, kLayers> step_m{};
  /// Points that interpolation gets as near as this may be left out, metres; 0: every point is
  /// kept. The first layer is always kept.
  std::array<double, kLayers> tolerance_m{};
};

/// Levels 0 (finest) to 5. 0 and 1 keep every point, within 2 and 5 cm; from 2 on points are left
/// out which `DecoderOptions::fill` interpolates. docs/benchmarks.md has what each gives.
inline constexpr std::array<BeamQuality, 6> kBeamLevels{{
    {{0.04, 0.04, 0.04, 0.04, 0.04}, {}},
    {{0.1, 0.1, 0.1, 0.1, 0.1}, {}},
    {{0.0905, 0.0905, 0.0905, 0.0905, 0.19}, {0, 0, 0, 0, 0.75}},
    {{0.1, 0.1, 0.12, 0.2, 0.2}, {0, 0, 0, 1.0, 1000}},
    {{0.12, 0.14, 0.2, 0.2, 0.2}, {0, 0, 0.2, 12, 1000}},
    {{0.12, 0.26, 0.28, 0.26, 0.26}, {0, 0.7, 8, 1000, 1000}},
}};

}  // namespace sweepcast
