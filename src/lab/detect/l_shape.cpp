#include "lab/detect/l_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace sweepcast::lab {

namespace {

struct Extents {
  double low_along, high_along, low_across, high_across;
};

struct Direction {
  double cosine, sine;
  [[nodiscard]] double along(const Eigen::Vector2d& p) const {
    return cosine * p.x() + sine * p.y();
  }
  [[nodiscard]] double across(const Eigen::Vector2d& p) const {
    return cosine * p.y() - sine * p.x();
  }
};

Extents extents_of(std::span<const Eigen::Vector2d> points, const Direction& direction) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Extents e{kInfinity, -kInfinity, kInfinity, -kInfinity};
  for (const Eigen::Vector2d& p : points) {
    e.low_along = std::min(e.low_along, direction.along(p));
    e.high_along = std::max(e.high_along, direction.along(p));
    e.low_across = std::min(e.low_across, direction.across(p));
    e.high_across = std::max(e.high_across, direction.across(p));
  }
  return e;
}

// Sum of the inverse distances to the nearest side.
double closeness(std::span<const Eigen::Vector2d> points, const Direction& direction) {
  constexpr double kLeast = 0.03;  // metres: nearer counts no more, it is noise
  const Extents e = extents_of(points, direction);
  double sum = 0.0;
  for (const Eigen::Vector2d& p : points) {
    const double u = direction.along(p), v = direction.across(p);
    const double side = std::min(std::min(u - e.low_along, e.high_along - u),
                                 std::min(v - e.low_across, e.high_across - v));
    sum += 1.0 / std::max(side, kLeast);
  }
  return sum;
}

}  // namespace

Rectangle fit_l_shape(std::span<const Eigen::Vector2d> points) {
  constexpr int kDirections = 45;
  constexpr double kStep = 0.5 * std::numbers::pi / kDirections;
  if (points.empty()) return {};
  Rectangle best;
  double most = -1.0;
  for (int i = 0; i < kDirections; ++i) {
    const double yaw = i * kStep;
    const Direction direction{std::cos(yaw), std::sin(yaw)};
    const double close = closeness(points, direction);
    if (close <= most) continue;
    most = close;
    const Extents e = extents_of(points, direction);
    const double u = 0.5 * (e.low_along + e.high_along);
    const double v = 0.5 * (e.low_across + e.high_across);
    best.centre = {direction.cosine * u - direction.sine * v,
                   direction.sine * u + direction.cosine * v};
    best.along = e.high_along - e.low_along;
    best.across = e.high_across - e.low_across;
    best.yaw = yaw;
  }
  return best;
}

}  // namespace sweepcast::lab
