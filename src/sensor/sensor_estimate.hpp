// The two ways to a sensor's model; sensor_model_estimate.cpp says which serves.
#pragma once

#include <span>

#include "sweepcast/sensor_model.hpp"

namespace sweepcast {

/// The model of sweeps in the sensor's own frame. `use_ring`: every sweep has rings, to be trusted.
/// Errors: invalid_argument (too few points), unsupported (no beams).
[[nodiscard]] Result<SensorEstimate> estimate_still(std::span<const CloudView> sweeps,
                                                    bool use_ring,
                                                    const SensorEstimateOptions& options);

/// The same of deskewed sweeps: the motion of the first straightens the beams, those of the others
/// follow from the beams, and all sweeps undone give the model.
[[nodiscard]] Result<SensorEstimate> estimate_deskewed(std::span<const CloudView> sweeps,
                                                       SensorEstimateOptions options);

/// The motion of every sweep, those that an estimate passed over too, by the final model.
void fill_motions(std::span<const CloudView> sweeps, SensorEstimate& estimate);

}  // namespace sweepcast
