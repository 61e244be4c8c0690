// Simulated sweeps as examples to train a detector with. Knows no network.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "lab/detect/anchors.hpp"
#include "lab/detect/boxes.hpp"
#include "lab/detect/pillars.hpp"
#include "lab/random.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// A sweep with its boxes.
struct LabelledSweep {
  std::vector<float> x, y, z;
  std::vector<Box> boxes;
};

/// Reads every `stride`th sweep of a drive that `simulate` wrote.
/// Errors: not_found (no such folder, no sweeps in it), and those of reading clouds and boxes.
[[nodiscard]] Result<std::vector<LabelledSweep>> read_drive(const std::filesystem::path& drive,
                                                            int stride);

/// One example.
struct Example {
  Pillars pillars;
  AnchorTargets targets;
};

/// Makes an example of a sweep, changed at random: turned, mirrored, its points fewer and their
/// ranges noisy.
[[nodiscard]] Example make_example(const LabelledSweep& sweep, Random& random);

}  // namespace sweepcast::lab
