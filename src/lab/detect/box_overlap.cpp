#include "lab/detect/box_overlap.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace sweepcast::lab {

namespace {

using Corner = Eigen::Vector2d;
using Outline = std::vector<Corner>;

double cross(const Corner& a, const Corner& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Counter-clockwise, about `origin`, so that differences of large coordinates lose nothing.
Outline outline_of(const Box& box, const Corner& origin) {
  const Corner ahead = 0.5 * box.length * Corner(std::cos(box.yaw), std::sin(box.yaw));
  const Corner left = 0.5 * box.width * Corner(-std::sin(box.yaw), std::cos(box.yaw));
  const Corner middle = box.centre.head<2>() - origin;
  return {middle + ahead + left, middle - ahead + left, middle - ahead - left,
          middle + ahead - left};
}

// What of a convex outline lies to the left of the line from `a` to `b` (Sutherland and Hodgman,
// Reentrant polygon clipping, 1974).
Outline clip(const Outline& outline, const Corner& a, const Corner& b) {
  Outline kept;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Corner& p = outline[i];
    const Corner& q = outline[(i + 1) % outline.size()];
    const double p_side = cross(b - a, p - a);
    const double q_side = cross(b - a, q - a);
    if (p_side >= 0.0) kept.push_back(p);
    if ((p_side > 0.0 && q_side < 0.0) || (p_side < 0.0 && q_side > 0.0)) {
      kept.push_back(p + (q - p) * (p_side / (p_side - q_side)));
    }
  }
  return kept;
}

double area_of(const Outline& outline) {
  double twice = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    twice += cross(outline[i], outline[(i + 1) % outline.size()]);
  }
  return std::max(0.0, 0.5 * twice);
}

double over_union(double shared, double a, double b) {
  const double whole = a + b - shared;
  return whole > 0.0 ? std::clamp(shared / whole, 0.0, 1.0) : 0.0;
}

}  // namespace

double shared_area(const Box& a, const Box& b) {
  const Corner origin = a.centre.head<2>();
  const double reach = 0.5 * (std::hypot(a.length, a.width) + std::hypot(b.length, b.width));
  if ((b.centre.head<2>() - origin).norm() > reach) return 0.0;
  Outline shared = outline_of(a, origin);
  const Outline other = outline_of(b, origin);
  for (std::size_t i = 0; i < other.size() && !shared.empty(); ++i) {
    shared = clip(shared, other[i], other[(i + 1) % other.size()]);
  }
  return area_of(shared);
}

double bev_iou(const Box& a, const Box& b) {
  return over_union(shared_area(a, b), a.length * a.width, b.length * b.width);
}

double iou_3d(const Box& a, const Box& b) {
  const double top = std::min(a.centre.z() + 0.5 * a.height, b.centre.z() + 0.5 * b.height);
  const double bottom = std::max(a.centre.z() - 0.5 * a.height, b.centre.z() - 0.5 * b.height);
  const double shared = shared_area(a, b) * std::max(0.0, top - bottom);
  return over_union(shared, a.length * a.width * a.height, b.length * b.width * b.height);
}

}  // namespace sweepcast::lab
