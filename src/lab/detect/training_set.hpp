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

/// A sweep with its boxes, both as they lie at the last firing and as they were met.
struct LabelledSweep {
  std::vector<float> x, y, z;
  std::vector<Box> at_last;
  std::vector<Box> as_met;
};

/// Moves the boxes of a raw sweep from where things were at its last firing to where its beams met
/// them, by what they moved since the sweep before. The same thing is known by its size, which
/// `simulate` draws anew for each. Those that were not seen before stay, with 0 points.
[[nodiscard]] std::vector<Box> boxes_as_met(std::span<const Box> at_last,
                                            std::span<const Box> before);

/// Reads every `stride`th sweep of a drive that `simulate` wrote, from the second one on.
/// Errors: not_found (no such folder, no sweeps in it), and those of reading clouds and boxes.
[[nodiscard]] Result<std::vector<LabelledSweep>> read_drive(const std::filesystem::path& drive,
                                                            int stride);

/// One example.
struct Example {
  Pillars pillars;
  AnchorTargets targets;
};

/// Makes an example of a sweep, changed at random: turned, mirrored, its points fewer and their
/// ranges noisy. Half of the examples have boxes as they were met and points without age.
[[nodiscard]] Example make_example(const LabelledSweep& sweep, Random& random);

}  // namespace sweepcast::lab
