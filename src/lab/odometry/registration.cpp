#include "lab/odometry/registration.hpp"

#include <Eigen/Cholesky>

namespace sweepcast::lab {

namespace {

struct NormalEquations {
  Eigen::Matrix<double, 6, 6> matrix = Eigen::Matrix<double, 6, 6>::Zero();
  Twist vector = Twist::Zero();
};

// One pair: the residual's derivative by a small motion from the left is [I, -cross(point)].
void add_pair(const Eigen::Vector3d& point, const Eigen::Vector3d& target, double kernel,
              NormalEquations& sum) {
  const Eigen::Vector3d residual = point - target;
  const double share = kernel / (kernel + residual.squaredNorm());
  const double weight = share * share;
  Eigen::Matrix<double, 3, 6> derivative;
  derivative.leftCols<3>().setIdentity();
  derivative.rightCols<3>() = -cross_matrix(point);
  sum.matrix.noalias() += weight * derivative.transpose() * derivative;
  sum.vector.noalias() -= weight * derivative.transpose() * residual;
}

}  // namespace

RigidTransform register_points(const Points& points, const VoxelMap& map,
                               const RigidTransform& guess, const RegistrationOptions& options) {
  if (map.empty() || points.empty()) return guess;
  const double max_square = options.max_distance_m * options.max_distance_m;
  RigidTransform pose = guess;
  Points moved(points.size());
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    NormalEquations sum;
    for (std::size_t i = 0; i < points.size(); ++i) {
      moved[i] = pose * points[i];
      const auto target = map.nearest(moved[i]);
      if (!target || (*target - moved[i]).squaredNorm() > max_square) continue;
      add_pair(moved[i], *target, options.kernel, sum);
    }
    if (sum.matrix.isZero()) return guess;
    const Twist step = sum.matrix.ldlt().solve(sum.vector);
    pose = exp(step) * pose;
    if (step.norm() < options.convergence) break;
  }
  // Products of rotations drift from being rotations, and a prediction doubles what has drifted.
  pose.linear() = Eigen::Quaterniond(pose.linear()).normalized().toRotationMatrix();
  return pose;
}

}  // namespace sweepcast::lab
