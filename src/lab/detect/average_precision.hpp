// How well boxes were found: average precision as KITTI's benchmark has it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lab/detect/boxes.hpp"

namespace sweepcast::lab {

/// Which boxes count. A true box that does not count is neither to be found nor wrong to be found.
struct ScoreOptions {
  std::string label = "Car";
  /// Labels that are much like it: true boxes of these do not count, as vans do not in KITTI's
  /// class Car. Other labels are as good as absent.
  std::vector<std::string> alike{"Van", "Truck", "Misc", "Pickup Truck", "Medium-sized Truck"};
  int min_points = 10;        ///< true boxes with fewer do not count, unless they are not counted
  double max_range_m = 50.0;  ///< nor boxes whose centre is farther, horizontally
  int recall_points = 40;     ///< 40 (KITTI since 2019) or 11 (before)
};

/// Average precisions, per cent: of the boxes' outlines on the ground (BEV) and of the boxes
/// themselves (3-D), where a box is found if the intersection over union is at least 0.5 or 0.7.
struct DetectionScore {
  double bev_ap50 = 0.0, bev_ap70 = 0.0, ap50_3d = 0.0, ap70_3d = 0.0;
};

/// Scores the boxes that were found in some sweeps; both spans have an entry a sweep, in the same
/// order. 0 where no true box counts.
[[nodiscard]] DetectionScore detection_score(std::span<const std::vector<Box>> truth,
                                             std::span<const std::vector<Box>> found,
                                             const ScoreOptions& options = {});

/// What became of a box that was found: its score, and whether it is right.
struct Judged {
  double score = 0.0;
  bool right = false;
};

/// Average precision, 0 to 1, of judged boxes where `wanted` were to be found: the mean, over
/// `recall_points` recalls (11: 0, 0.1, ... 1; 40: 1/40, ... 1), of the best precision at that
/// recall or a higher one. Boxes of equal score come in or stay out together.
[[nodiscard]] double average_precision(std::vector<Judged> judged, int wanted, int recall_points);

}  // namespace sweepcast::lab
