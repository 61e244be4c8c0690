#include "lab/odometry/rigid.hpp"

#include <cmath>

namespace sweepcast::lab {

namespace {

constexpr double kSmallAngle = 1e-6;  // radians below which the series' first terms are exact

// Maps the translation of a twist to that of its motion.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm();
  const Eigen::Matrix3d hat = cross_matrix(rotation);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + 0.5 * hat;
  const double square = angle * angle;
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / square * hat +
         (angle - std::sin(angle)) / (square * angle) * hat * hat;
}

}  // namespace

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d hat;
  hat << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return hat;
}

RigidTransform exp(const Twist& twist) {
  const Eigen::Vector3d rotation = twist.tail<3>();
  const double angle = rotation.norm();
  RigidTransform motion = RigidTransform::Identity();
  if (angle < kSmallAngle) {
    motion.linear() = Eigen::Quaterniond(1.0, rotation.x() / 2, rotation.y() / 2, rotation.z() / 2)
                          .normalized()
                          .toRotationMatrix();
  } else {
    motion.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  }
  motion.translation() = left_jacobian(rotation) * twist.head<3>();
  return motion;
}

Twist log(const RigidTransform& motion) {
  const Eigen::AngleAxisd turn(Eigen::Quaterniond(motion.linear()));
  const Eigen::Vector3d rotation = turn.angle() * turn.axis();
  Twist twist;
  twist.head<3>() = left_jacobian(rotation).inverse() * motion.translation();
  twist.tail<3>() = rotation;
  return twist;
}

}  // namespace sweepcast::lab
