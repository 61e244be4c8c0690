// The QoE of what a live sender sends; see rate/qoe.hpp.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "rate/qoe.hpp"

namespace sweepcast::link {

/// Of one sensor's last sweeps. A sweep that did not leave whole counts as the coarsest level, 0:
/// what its layers are worth, the simulator measures and nobody knows live.
class QoeMeter {
 public:
  static constexpr std::size_t kSweeps = 100;

  /// A sweep of which it is known what became of it. One of no level begins anew.
  void add(std::optional<std::size_t> level, std::size_t queued, bool left_whole);

  /// Equation 5 over the number of sweeps. None where the newest sweep has no level.
  [[nodiscard]] std::optional<double> mean() const;

 private:
  std::vector<QoeSweep> sweeps_;
};

}  // namespace sweepcast::link
