// A rectangle about the visible sides of a car.
#pragma once

#include <Eigen/Core>
#include <span>

namespace sweepcast::lab {

/// A rectangle on the ground, metres: `along` and `across` are its extents in the direction `yaw`
/// and to the left of it.
struct Rectangle {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double along = 0.0, across = 0.0;
  double yaw = 0.0;  ///< radians, in [0, pi / 2)
};

/// The rectangle about points that lie on one or two of its sides: of all directions that whose
/// sides the points are closest to (Zhang, Xu, Dong and Dolan, Efficient L-shape fitting for
/// vehicle detection using laser scanners, IV 2017, closeness criterion). All zero without points.
[[nodiscard]] Rectangle fit_l_shape(std::span<const Eigen::Vector2d> points);

}  // namespace sweepcast::lab
