// Deskewed sweeps: the twist that a sweep was moved by, undone and done again.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/trig.hpp"
#include "sweepcast/sensor_model.hpp"

namespace sweepcast {

/// The twist of a motion. From + - * / alone: with doubles encoder and decoder agree to the bit;
/// floats are for projection, which need not.
template <class Real>
class Twist {
 public:
  using Point = std::array<Real, 3>;

  explicit Twist(const Motion& motion) : Twist(motion.translation, motion.rotation) {}
  /// A mount is a twist by s = 1.
  explicit Twist(const Mount& mount) : Twist(mount.translation, mount.rotation) {}

  /// `translation` in 10 um, `rotation` in 1e-6 degree.
  Twist(const std::array<std::int32_t, 3>& translation,
        const std::array<std::int32_t, 3>& rotation) {
    double squared = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double angle = static_cast<double>(rotation[i]) / kAngleUnits * kDegree;
      rotation_[i] = static_cast<Real>(angle);
      translation_m_[i] = static_cast<Real>(static_cast<double>(translation[i]) / kLengthUnits);
      squared += angle * angle;
    }
    angle_squared_ = static_cast<Real>(squared);
  }

  /// p = R(s * rotation) q + s * translation: from the deskewed point to the sensor's own.
  [[nodiscard]] Point undo(const Point& q, Real s) const {
    const Point p = turn(q, s);
    const Point& v = translation_m_;
    return {p[0] + s * v[0], p[1] + s * v[1], p[2] + s * v[2]};
  }

  /// The inverse: q = R(s * rotation)^T (p - s * translation).
  [[nodiscard]] Point redo(const Point& p, Real s) const {
    const Point& v = translation_m_;
    return turn({p[0] - s * v[0], p[1] - s * v[1], p[2] - s * v[2]}, -s);
  }

 private:
  // Rodrigues: p + a (w x p) + b (w x (w x p)) with a = sin(s|w|) / |w|, b = (1 - cos(s|w|)) /
  // |w|^2 as power series, which need no |w|; sweeps and mounts turn by little more than a radian.
  [[nodiscard]] Point turn(const Point& p, Real s) const {
    const Point& w = rotation_;
    constexpr Real k1 = 1;
    constexpr auto over = [](int n) { return static_cast<Real>(1.0 / n); };
    const Real u = s * s * angle_squared_;
    const Real a =
        s * (k1 - u * over(6) * (k1 - u * over(20) * (k1 - u * over(42) * (k1 - u * over(72)))));
    const Real b =
        s * s * over(2) *
        (k1 - u * over(12) * (k1 - u * over(30) * (k1 - u * over(56) * (k1 - u * over(90)))));
    const Point c = cross(w, p);
    const Point d = cross(w, c);
    return {p[0] + a * c[0] + b * d[0], p[1] + a * c[1] + b * d[1], p[2] + a * c[2] + b * d[2]};
  }

  static Point cross(const Point& w, const Point& p) {
    return {w[1] * p[2] - w[2] * p[1], w[2] * p[0] - w[0] * p[2], w[0] * p[1] - w[1] * p[0]};
  }

  Point translation_m_{}, rotation_{};  // rotation in radians
  Real angle_squared_ = 0;
};

/// A motion's nod as a tangent.
[[nodiscard]] inline double nod_of(const Motion& motion) {
  return static_cast<double>(motion.nod) / kTangentUnits;
}

/// What brings a cloud into the sensor's frame at a sweep's time 0.
[[nodiscard]] inline const Mount& mount_of(const SensorModel& model,
                                           const std::optional<Motion>& motion) {
  return motion ? motion->mount : model.mount;
}

/// Time of a whole tick within the sweep: turns from the motion's zero, [-1/2, 1/2).
[[nodiscard]] inline double motion_time(int tick, const Motion& motion, int ticks_per_turn) {
  int from_zero = (tick - motion.zero_tick) % ticks_per_turn;
  if (from_zero < 0) from_zero += ticks_per_turn;
  if (2 * from_zero >= ticks_per_turn) from_zero -= ticks_per_turn;
  return static_cast<double>(from_zero) / ticks_per_turn;
}

}  // namespace sweepcast
