// Vectors and rigid poses of the simulated world, in double. Only + - * / and square root, so that
// every machine gets the same bits.
#pragma once

#include <cmath>

namespace sweepcast::lab {

struct Vec3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};

constexpr Vec3 operator+(Vec3 a, Vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
constexpr Vec3 operator-(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
constexpr Vec3 operator*(Vec3 a, double s) {
  return {a.x * s, a.y * s, a.z * s};
}
constexpr double dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3 a) {
  return std::sqrt(dot(a, a));
}
inline Vec3 normalized(Vec3 a) {
  return a * (1.0 / length(a));
}

/// A right-handed orthonormal frame: axes and origin in the parent's coordinates.
struct Pose {
  Vec3 x{1.0, 0.0, 0.0};
  Vec3 y{0.0, 1.0, 0.0};
  Vec3 z{0.0, 0.0, 1.0};
  Vec3 origin;

  /// A direction from this frame to the parent's.
  [[nodiscard]] constexpr Vec3 rotate(Vec3 v) const { return x * v.x + y * v.y + z * v.z; }
  /// A point from this frame to the parent's.
  [[nodiscard]] constexpr Vec3 apply(Vec3 v) const { return rotate(v) + origin; }
  /// A direction from the parent's frame to this one.
  [[nodiscard]] constexpr Vec3 unrotate(Vec3 v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
  /// A point from the parent's frame to this one.
  [[nodiscard]] constexpr Vec3 invert(Vec3 v) const { return unrotate(v - origin); }
  /// This frame, whose parent is the world, as seen from `base`, whose parent is the world too.
  [[nodiscard]] constexpr Pose relative_to(const Pose& base) const {
    return {base.unrotate(x), base.unrotate(y), base.unrotate(z), base.invert(origin)};
  }
};

/// An upright frame at `origin`, its x axis along (cosine, sine) in the horizontal plane.
constexpr Pose upright(Vec3 origin, double cosine, double sine) {
  return {{cosine, sine, 0.0}, {-sine, cosine, 0.0}, {0.0, 0.0, 1.0}, origin};
}

}  // namespace sweepcast::lab
