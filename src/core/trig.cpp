#include "core/trig.hpp"

#include <cmath>

namespace sweepcast {
namespace {

// pi/2 in two parts, the first with 33 bits: its products with small integers are exact.
constexpr double kHalfPiHigh = 1.57079632673412561417;
constexpr double kHalfPiLow = 6.07710050650619224932e-11;

// Taylor series on [-pi/4, pi/4]; the first term left out is under 1e-17.
SinCos sin_cos_octant(double x) noexcept {
  const double u = x * x;
  double s = 1.0;
  for (int k = 17; k >= 3; k -= 2) s = 1.0 - s * u / static_cast<double>((k - 1) * k);
  double c = 1.0;
  for (int k = 18; k >= 2; k -= 2) c = 1.0 - c * u / static_cast<double>((k - 1) * k);
  return {s * x, c};
}

// atan on [0, 1]: tan(a/2) = t / (1 + sqrt(1 + t^2)), twice, leaves t <= 0.199.
double atan_unit(double t) noexcept {
  for (int i = 0; i < 2; ++i) t = t / (1.0 + std::sqrt(1.0 + t * t));
  const double u = t * t;
  double sum = 0.0;
  for (int k = 23; k >= 1; k -= 2) {
    sum = 1.0 / static_cast<double>(k) - u * sum;
  }
  return 4.0 * t * sum;
}

}  // namespace

SinCos sin_cos(double radians) noexcept {
  const double turns = radians * (2.0 / kPi);
  const auto quadrant = static_cast<long long>(turns < 0.0 ? turns - 0.5 : turns + 0.5);
  const auto q = static_cast<double>(quadrant);
  const SinCos r = sin_cos_octant((radians - q * kHalfPiHigh) - q * kHalfPiLow);
  switch (quadrant & 3) {
    case 0:
      return r;
    case 1:
      return {r.cos, -r.sin};
    case 2:
      return {-r.sin, -r.cos};
    default:
      return {-r.cos, r.sin};
  }
}

double arc_tangent(double y, double x) noexcept {
  const double ax = x < 0.0 ? -x : x;
  const double ay = y < 0.0 ? -y : y;
  if (ax == 0.0 && ay == 0.0) return 0.0;
  double angle = ax > ay ? atan_unit(ay / ax) : kPi / 2.0 - atan_unit(ax / ay);
  if (x < 0.0) angle = kPi - angle;
  return y < 0.0 ? -angle : angle;
}

}  // namespace sweepcast
