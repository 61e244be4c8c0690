// The quality of experience of the RCPCC paper, equation 5, and its constants (section IV.D).
#pragma once

#include <cstddef>
#include <span>

namespace sweepcast {

/// Levels of the ladders.
inline constexpr std::size_t kLevels = 6;

/// mu: what a frame waiting costs, in points of quality.
inline constexpr double kQueueWeight = 0.5;

/// q(i) = 25 - 5 i: the quality of a sweep sent at a level. A sweep that is not sent has 0, as the
/// coarsest level has.
[[nodiscard]] constexpr double level_quality(std::size_t level) {
  return 25.0 - 5.0 * static_cast<double>(level);
}

/// What equation 5 asks of a sweep.
struct QoeSweep {
  double quality = 0.0;    ///< q(R_i)
  std::size_t queued = 0;  ///< K_i: frames before it that were not fully sent when it was encoded
};

/// Equation 5: sum of q, less mu times the sum of K, less the sum of the changes of q. It is to be
/// made large: where the paper prints arg min, arg max is meant.
[[nodiscard]] double qoe(std::span<const QoeSweep> sweeps);

}  // namespace sweepcast
