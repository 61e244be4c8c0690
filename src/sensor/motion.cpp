#include "sensor/motion.hpp"

#include "core/trig.hpp"

namespace sweepcast {

Twist::Twist(const Motion& motion) {
  for (std::size_t i = 0; i < 3; ++i) {
    translation_m_[i] = static_cast<double>(motion.translation[i]) / kLengthUnits;
    rotation_[i] = static_cast<double>(motion.rotation[i]) / kAngleUnits * kDegree;
    angle_squared_ += rotation_[i] * rotation_[i];
  }
}

// Rodrigues: p + a (w x p) + b (w x (w x p)) with a = sin(s|w|) / |w|, b = (1 - cos(s|w|)) / |w|^2
// as power series, which need no |w|; a sweep turns by well under a radian.
std::array<double, 3> Twist::turn(const std::array<double, 3>& p, double s) const {
  const auto& w = rotation_;
  const double u = s * s * angle_squared_;
  const double a = s * (1.0 - u / 6.0 * (1.0 - u / 20.0 * (1.0 - u / 42.0 * (1.0 - u / 72.0))));
  const double b =
      s * s * 0.5 * (1.0 - u / 12.0 * (1.0 - u / 30.0 * (1.0 - u / 56.0 * (1.0 - u / 90.0))));
  const std::array<double, 3> c{w[1] * p[2] - w[2] * p[1], w[2] * p[0] - w[0] * p[2],
                                w[0] * p[1] - w[1] * p[0]};
  const std::array<double, 3> d{w[1] * c[2] - w[2] * c[1], w[2] * c[0] - w[0] * c[2],
                                w[0] * c[1] - w[1] * c[0]};
  return {p[0] + a * c[0] + b * d[0], p[1] + a * c[1] + b * d[1], p[2] + a * c[2] + b * d[2]};
}

std::array<double, 3> Twist::undo(const std::array<double, 3>& q, double s) const {
  const std::array<double, 3> p = turn(q, s);
  return {p[0] + s * translation_m_[0], p[1] + s * translation_m_[1], p[2] + s * translation_m_[2]};
}

std::array<double, 3> Twist::redo(const std::array<double, 3>& p, double s) const {
  return turn(
      {p[0] - s * translation_m_[0], p[1] - s * translation_m_[1], p[2] - s * translation_m_[2]},
      -s);
}

}  // namespace sweepcast
