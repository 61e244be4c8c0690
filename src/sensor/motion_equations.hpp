// Least squares of a twist and a mount.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <tuple>
#include <vector>

#include "sensor/motion_fit.hpp"

namespace sweepcast {

/// What is known of the numbers beforehand: inverse variances about `about`.
struct MotionPrior {
  MotionVector weight{}, about{};
};

/// Normal equations of the motion with, for each group of residuals, two numbers of its own that
/// are eliminated: those of `rho` and of 1, a beam's tangent and height.
class MotionEquations {
 public:
  /// Without groups nothing is eliminated.
  explicit MotionEquations(std::size_t groups) : own_(groups) {}

  /// `slope`: what one more unit of each number does to the residual.
  void add(std::size_t group, double weight, double rho, double residual,
           const MotionVector& slope) {
    Own& own = own_[group];
    own.rr += weight * rho * rho;
    own.r += weight * rho;
    own.w += weight;
    for (std::size_t i = 0; i <= kNumbers; ++i) {
      const double value = i < kNumbers ? slope[i] : residual;
      own.cross_r[i] += weight * rho * value;
      own.cross_1[i] += weight * value;
    }
    add(weight, residual, slope);
  }

  void add(double weight, double residual, const MotionVector& slope) {
    Row row{};
    std::copy(slope.begin(), slope.end(), row.begin());
    row[kNumbers] = residual;
    for (std::size_t i = 0; i <= kNumbers; ++i) {
      const double scaled = weight * row[i];
      for (std::size_t j = 0; j <= kNumbers; ++j) sums_[i][j] += scaled * row[j];
    }
  }

  /// The step from `at` that lowers the residuals most, the groups' own numbers free.
  [[nodiscard]] MotionVector solve(const MotionPrior& prior, const MotionVector& at) {
    reduce();
    auto& m = sums_;
    for (std::size_t i = 0; i < kNumbers; ++i) {
      m[i][i] += prior.weight[i];
      m[i][kNumbers] += prior.weight[i] * (at[i] - prior.about[i]);
    }
    for (std::size_t i = 0; i < kNumbers; ++i) {  // positive definite: no pivoting
      if (!(m[i][i] > 1e-12)) continue;
      for (std::size_t k = 0; k < kNumbers; ++k) {
        if (k == i) continue;
        const double factor = m[k][i] / m[i][i];
        for (std::size_t j = i; j <= kNumbers; ++j) m[k][j] -= factor * m[i][j];
      }
    }
    MotionVector step{};
    for (std::size_t i = 0; i < kNumbers; ++i) {
      step[i] = m[i][i] > 1e-12 ? -m[i][kNumbers] / m[i][i] : 0.0;
    }
    return step;
  }

 private:
  static constexpr std::size_t kNumbers = std::tuple_size_v<MotionVector>;
  using Row = std::array<double, kNumbers + 1>;

  struct Own {
    double rr = 0, r = 0, w = 0;
    Row cross_r{}, cross_1{};
  };

  void reduce() {
    for (const Own& own : own_) {
      const double det = own.rr * own.w - own.r * own.r;
      if (!(det > 1e-9 * own.rr * own.w)) continue;
      for (std::size_t i = 0; i <= kNumbers; ++i) {
        const double a = (own.w * own.cross_r[i] - own.r * own.cross_1[i]) / det;
        const double b = (own.rr * own.cross_1[i] - own.r * own.cross_r[i]) / det;
        for (std::size_t j = 0; j <= kNumbers; ++j) {
          sums_[i][j] -= a * own.cross_r[j] + b * own.cross_1[j];
        }
      }
    }
  }

  std::vector<Own> own_;
  std::array<Row, kNumbers + 1> sums_{};
};

}  // namespace sweepcast
