// What PointPillars' network is asked for: at each cell of its output, how far boxes of a usual
// size (anchors) are from true ones (Lang et al., PointPillars, CVPR 2019, 2.3 and 3.2). Knows no
// network.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lab/detect/boxes.hpp"
#include "lab/detect/pillars.hpp"

namespace sweepcast::lab {

inline constexpr int kOutputSide = PillarGrid::kSide / 2;  ///< cells in a row and in a column
inline constexpr int kAnchorsOfCell = 2;                   ///< along x, along y
inline constexpr int kAnchors = kOutputSide * kOutputSide * kAnchorsOfCell;
inline constexpr int kResiduals = 7;

/// An anchor's box by its index: (row * kOutputSide + column) * kAnchorsOfCell + which. Its height
/// above the ground is that of a sensor on a car's roof.
[[nodiscard]] Box anchor(int index);

/// What the network is to say of one sweep.
struct AnchorTargets {
  /// Of each anchor: 1 where it lies on a car or van, 0 where on none, -1 in between.
  std::vector<float> state;
  std::vector<std::int64_t> positive;  ///< the anchors of state 1
  std::vector<float> residuals;        ///< kResiduals of each of them
  std::vector<std::int64_t> backward;  ///< 1 where its box points away from the anchor, else 0
};

/// Positive are anchors whose outline has an IoU of at least 0.55 with a box, and the best of each
/// box; negative those with less than 0.4 with all. Boxes with fewer than `min_points` points are
/// neither: anchors on them do not count.
[[nodiscard]] AnchorTargets assign_targets(std::span<const Box> boxes, int min_points);

/// What the network says of an anchor, as a box: a car, or, where it is over 1.76 m high, a van.
[[nodiscard]] Box decode_box(int index, std::span<const float, kResiduals> residuals, bool backward,
                             double score);

/// Keeps the best scored of boxes that overlap by more than `most` (bird's-eye IoU), best first;
/// each becomes the mean, weighted by scores, of itself and those that overlap it by half or more.
[[nodiscard]] std::vector<Box> suppress_overlaps(std::vector<Box> boxes, double most);

}  // namespace sweepcast::lab
