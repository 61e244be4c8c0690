#include "lab/odometry/sweep_clock.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace sweepcast::lab {

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

}  // namespace

// The mean of unit vectors along "share less azimuth" is long only for the right sense, and points
// to the start.
std::optional<SweepClock> SweepClock::learn(const PointCloud& timed) {
  constexpr double kAgreement = 0.9;
  if (!timed.has_time() || timed.empty()) return {};
  const auto [first, last] = std::minmax_element(timed.time_ns.begin(), timed.time_ns.end());
  const auto period = static_cast<double>(*last - *first);
  if (period <= 0.0) return {};
  std::complex<double> along = 0.0, against = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < timed.size(); ++i) {
    const double azimuth = std::atan2(timed.y[i], timed.x[i]);
    if (!std::isfinite(azimuth)) continue;
    const double share = static_cast<double>(timed.time_ns[i] - *first) / period;
    along += std::polar(1.0, kTurn * share - azimuth);
    against += std::polar(1.0, kTurn * share + azimuth);
    count += 1.0;
  }
  const bool is_along = std::abs(along) > std::abs(against);
  const std::complex<double> sum = is_along ? along : against;
  if (std::abs(sum) < kAgreement * count) return {};
  return SweepClock(is_along ? 1.0 : -1.0, std::arg(sum) / kTurn);
}

void SweepClock::tell(const PointCloud& cloud, std::vector<float>& when) const {
  when.resize(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double turns = sense_ * std::atan2(cloud.y[i], cloud.x[i]) / kTurn + start_;
    when[i] = std::isfinite(turns) ? static_cast<float>(turns - std::floor(turns)) : 0.0F;
  }
}

}  // namespace sweepcast::lab
