// Sine, cosine and arc tangent from + - * / and square root alone. The C library's differ in the
// last bit from one machine to the next; these do not, since IEEE 754 fixes each of those
// operations and the build forbids fused multiply-add.
#pragma once

#include <cmath>

namespace sweepcast {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kTwoPi = 2.0 * kPi;
inline constexpr double kDegree = kPi / 180.0;  ///< radians
inline constexpr float kTurnsPerRadian = static_cast<float>(1.0 / kTwoPi);

struct SinCos {
  double sin = 0.0;
  double cos = 1.0;
};

/// Both at once. |radians| at most 1e6; error under 4e-16. Taylor series on [-pi/4, pi/4].
[[nodiscard]] SinCos sin_cos(double radians) noexcept;

/// Angle of the point (x, y) from the x axis, radians in [-pi, pi]; 0 at the origin.
/// Error under 1e-15. Taylor series after halving the angle twice.
[[nodiscard]] double arc_tangent(double y, double x) noexcept;

/// What is left of `turns` by the nearest whole number of them: in [-0.5, 0.5).
[[nodiscard]] inline double wrap(double turns) noexcept {
  return turns - std::floor(turns + 0.5);
}

/// As above in float, for many points at a time: error under 5e-7 rad. A minimax polynomial
/// (Remez, degree 7 in t^2 on [0, 1]); free of branches, so that compilers vectorise loops over it.
[[nodiscard]] inline float arc_tangent_fast(float y, float x) noexcept {
  const float ay = y < 0.0F ? -y : y;
  const float ax = x < 0.0F ? -x : x;
  const float large = ax > ay ? ax : ay;
  const float small = ax > ay ? ay : ax;
  const float t = small / (large > 1e-30F ? large : 1e-30F);
  const float u = t * t;
  float p = -0.004054567935F;
  p = p * u + 0.02186296069F;
  p = p * u - 0.05591233116F;
  p = p * u + 0.09642197676F;
  p = p * u - 0.1390862969F;
  p = p * u + 0.1994656568F;
  p = p * u - 0.3332986079F;
  p = p * u + 0.9999993356F;
  const float octant = p * t;
  const float quadrant = ay > ax ? 1.57079632679F - octant : octant;
  const float half = x < 0.0F ? 3.14159265359F - quadrant : quadrant;
  return y < 0.0F ? -half : half;
}

}  // namespace sweepcast
