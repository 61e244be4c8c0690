// What each stage of codec beam is worth: bytes of the same sweeps without it.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sweepcast/encoder.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// The codec with one stage replaced by the nearest simpler thing.
struct StageRow {
  std::string stage;    ///< as in "prediction"; empty for the codec as it is
  std::string instead;  ///< what takes its place, as in "the value before"
  double bytes = 0;     ///< of a frame, mean over the sweeps, the sensor's model included
  double factor = 1;    ///< bytes over those of the row to compare with: the last with no stage
};

struct StageAblationOptions {
  double max_error_m = 0.05;
  Effort effort = Effort::normal;
  std::function<void(std::string_view)> on_sweep{};  ///< called after each sweep with its name
};

/// Measures all stages. The sweeps must be of one sensor. Frames are whole ones of `Encoder`, but
/// for the parts that the stage changes, which are coded again without it. What a frame has no
/// place for (no prediction, no choices at edges) could be told in a byte.
/// Errors: those of `read_cloud` and of the encoder, naming the file; invalid_argument (no sweep,
/// options out of range), unsupported (sweeps without a sensor model).
[[nodiscard]] Result<std::vector<StageRow>> ablate_stages(
    std::span<const std::filesystem::path> sweeps, const StageAblationOptions& options);

}  // namespace sweepcast::lab
