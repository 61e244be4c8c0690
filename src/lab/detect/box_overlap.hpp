// How far two boxes overlap: exactly, by clipping one outline by the other.
#pragma once

#include "lab/detect/boxes.hpp"

namespace sweepcast::lab {

/// Area, square metres, that the outlines of both boxes on the ground have in common.
[[nodiscard]] double shared_area(const Box& a, const Box& b);

/// Intersection over union of the outlines on the ground (bird's-eye view), 0 to 1.
[[nodiscard]] double bev_iou(const Box& a, const Box& b);

/// The same of the boxes' volumes.
[[nodiscard]] double iou_3d(const Box& a, const Box& b);

}  // namespace sweepcast::lab
