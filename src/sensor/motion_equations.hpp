// Least squares of a twist.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "sensor/motion_fit.hpp"

namespace sweepcast {

/// Normal equations of the twist with, for each group of residuals, two numbers of its own that are
/// eliminated: those of `rho` and of 1. For heights they are a beam's tangent and height, for
/// azimuths (sideways, in metres) its azimuth offset and lateral offset.
class TwistEquations {
 public:
  explicit TwistEquations(std::size_t groups) : own_(groups) {}

  void add(std::size_t group, double weight, double rho, double residual,
           const std::array<double, 6>& slope) {
    Own& own = own_[group];
    own.rr += weight * rho * rho;
    own.r += weight * rho;
    own.w += weight;
    for (std::size_t i = 0; i < 7; ++i) {
      const double value = i < 6 ? slope[i] : residual;
      own.cross_r[i] += weight * rho * value;
      own.cross_1[i] += weight * value;
    }
    add(weight, residual, slope);
  }

  void add(double weight, double residual, const std::array<double, 6>& slope) {
    std::array<double, 7> row{};
    std::copy(slope.begin(), slope.end(), row.begin());
    row[6] = residual;
    for (std::size_t i = 0; i < 7; ++i) {
      for (std::size_t j = i; j < 7; ++j) sums_[i][j] += weight * row[i] * row[j];
    }
  }

  // The step that lowers the residuals most. `eliminate`: with the groups' own numbers free.
  // `prior`: inverse variance of each number of the twist, about `at`.
  [[nodiscard]] TwistVector solve(bool eliminate, const TwistVector& prior, const TwistVector& at) {
    if (eliminate) reduce();
    std::array<std::array<double, 7>, 6> m{};
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < 7; ++j) m[i][j] = i <= j ? sums_[i][j] : sums_[j][i];
      m[i][i] += prior[i];
      m[i][6] += prior[i] * at[i];
    }
    for (std::size_t i = 0; i < 6; ++i) {  // positive definite: no pivoting
      if (!(m[i][i] > 1e-12)) continue;
      for (std::size_t k = 0; k < 6; ++k) {
        if (k == i) continue;
        const double factor = m[k][i] / m[i][i];
        for (std::size_t j = i; j < 7; ++j) m[k][j] -= factor * m[i][j];
      }
    }
    TwistVector step{};
    for (std::size_t i = 0; i < 6; ++i) step[i] = m[i][i] > 1e-12 ? -m[i][6] / m[i][i] : 0.0;
    return step;
  }

 private:
  struct Own {
    double rr = 0, r = 0, w = 0;
    std::array<double, 7> cross_r{}, cross_1{};
  };

  void reduce() {
    for (const Own& own : own_) {
      const double det = own.rr * own.w - own.r * own.r;
      if (!(det > 1e-9 * own.rr * own.w)) continue;
      for (std::size_t i = 0; i < 7; ++i) {
        const double a = (own.w * own.cross_r[i] - own.r * own.cross_1[i]) / det;
        const double b = (own.rr * own.cross_1[i] - own.r * own.cross_r[i]) / det;
        for (std::size_t j = i; j < 7; ++j) {
          sums_[i][j] -= a * own.cross_r[j] + b * own.cross_1[j];
        }
      }
    }
  }

  std::vector<Own> own_;
  std::array<std::array<double, 7>, 7> sums_{};
};

}  // namespace sweepcast
