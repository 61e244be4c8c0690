// Where a sensor sits in the frame of its clouds, with nothing known: a search.
#pragma once

#include <array>
#include <span>

#include "sensor/motion_fit.hpp"

namespace sweepcast {

/// The place and tilt from which the points' slopes z / rho gather most sharply, as those of a
/// spinning LiDAR's beams do: within 2 m aside, 1 m below to 3 m above the frame's origin, and 5
/// degrees. To a few centimetres and a tenth of a degree; a turn about z is not looked for.
/// Returns the mount's part of a motion, the rest 0.
[[nodiscard]] MotionVector search_mount(std::span<const std::array<float, 3>> points);

/// The same with a twist, from a mount found without; `zero`: where time is 0, turns. Returns the
/// sharpness, to compare places by. The twist's turn about z and its way along z stay.
[[nodiscard]] double search_twist(std::span<const std::array<float, 3>> points, double zero,
                                  MotionVector& motion);

}  // namespace sweepcast
