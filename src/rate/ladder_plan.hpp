// Levels of a ladder planned ahead for a link of a known, steady rate.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "rate/qoe.hpp"

namespace sweepcast {

/// Chooses the level with which equation 5 comes out largest over the next `kSweeps` sweeps, by
/// dynamic programming over the queue's length and the quality before. It finds, for one, when two
/// levels by turns are worth more than the one that always fits.
class LadderPlan {
 public:
  static constexpr std::size_t kSweeps = 60;

  /// `level_bytes`: what frames take as a rule; `sweep_bytes`: what the link takes a sweep, above
  /// 0.
  LadderPlan(std::span<const std::size_t> level_bytes, double sweep_bytes);

  /// The level for the next sweep, after one of level `last` and with so many bytes in the queue.
  [[nodiscard]] std::size_t choose(double queued_bytes, std::size_t last) const;

 private:
  /// Of the queue: so many steps a sweep's bytes, and so many sweeps.
  static constexpr std::size_t kSteps = 8;
  static constexpr std::size_t kLongest = 16;
  static constexpr std::size_t kQueues = kSteps * kLongest + 1;

  [[nodiscard]] double worth(double queue, std::size_t last, std::size_t level) const;
  [[nodiscard]] double later(double queue, std::size_t level) const;

  double sweep_bytes_;
  std::vector<double> frame_;  ///< what frames of each level take, in sweeps of the link
  std::vector<double> value_;  ///< of what is to come: [queue][level before]
};

}  // namespace sweepcast
