// Training of PointPillars' network on simulated drives.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

#include "lab/detect/training_set.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

struct TrainOptions {
  int steps = 4600;  ///< each on `batch` sweeps
  int batch = 2;
  double learning_rate = 3e-3;  ///< the highest; it rises over a quarter of the steps, then falls
  std::uint64_t seed = 1;       ///< decides first weights, order and changes of the examples
  int threads = 1;              ///< other numbers give other weights: sums are in another order
};

/// Trains on the sweeps and writes the weights. Losses are the paper's (section 3.2): focal for
/// scores, smooth L1 for residuals, cross entropy for directions; Adam with decoupled weight decay.
/// `progress(step, loss)` is called after each step, its loss being a running mean.
/// Errors: invalid_argument (no sweeps, an option outside its range), io, unsupported (a build
/// without libtorch).
[[nodiscard]] Status train_pillars(std::span<const LabelledSweep> sweeps,
                                   const TrainOptions& options,
                                   const std::filesystem::path& weights,
                                   const std::function<void(int, double)>& progress = {});

}  // namespace sweepcast::lab
