// Rigid motions and their logarithms, in double.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sweepcast::lab {

/// Takes points from one frame to another, metres.
using RigidTransform = Eigen::Isometry3d;

/// A motion's logarithm: three of translation (metres), three of rotation (radians). A sensor that
/// moves by `exp(twist)` at constant velocity has moved by `exp(s * twist)` after the share s.
using Twist = Eigen::Matrix<double, 6, 1>;

/// The matrix that multiplies as the cross product with `v` does.
[[nodiscard]] Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v);

/// The rigid motion of a twist, and back (rotations below half a turn). The closed forms of SE(3):
/// Barfoot, State Estimation for Robotics, 7.1.
[[nodiscard]] RigidTransform exp(const Twist& twist);
[[nodiscard]] Twist log(const RigidTransform& motion);

}  // namespace sweepcast::lab
