#include "lab/attribute_error.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sweepcast::lab {
namespace {

// Indices of the points that are finite and not at the origin.
std::vector<std::size_t> usable(const PointCloud& cloud) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const bool origin = cloud.x[i] == 0.0F && cloud.y[i] == 0.0F && cloud.z[i] == 0.0F;
    if (cloud.is_finite(i) && !origin) indices.push_back(i);
  }
  return indices;
}

template <class T>
double difference(T a, T b) {
  return std::abs(static_cast<double>(a) - static_cast<double>(b));
}
double difference(std::int64_t a, std::int64_t b) {
  // Unsigned: any two times have a difference.
  const auto apart =
      static_cast<std::uint64_t>(std::max(a, b)) - static_cast<std::uint64_t>(std::min(a, b));
  return static_cast<double>(apart);
}
// What is NaN on both sides is equal; on one side, as far off as can be.
double difference(float a, float b) {
  if (std::isnan(a) && std::isnan(b)) return 0.0;
  if (a == b) return 0.0;
  const double apart = std::abs(double{a} - double{b});
  return std::isnan(apart) ? HUGE_VAL : apart;
}

void take_worse(std::optional<double>& worst, const std::optional<double>& other) {
  if (other) worst = std::max(worst.value_or(0.0), *other);
}

}  // namespace

void AttributeErrors::add(const AttributeErrors& other) {
  take_worse(intensity, other.intensity);
  take_worse(ring, other.ring);
  take_worse(time_ns, other.time_ns);
}

AttributeErrors attribute_errors(const PointCloud& original, const PointCloud& decoded) {
  const std::vector<std::size_t> from = usable(original);
  const std::vector<std::size_t> partners = usable(decoded);
  AttributeErrors errors;
  if (from.empty() || from.size() != partners.size()) return errors;
  const auto worst = [&](const auto& a, const auto& b) -> std::optional<double> {
    if (a.empty() || b.empty()) return std::nullopt;
    double most = 0.0;
    for (std::size_t i = 0; i < from.size(); ++i) {
      most = std::max(most, difference(a[from[i]], b[partners[i]]));
    }
    return most;
  };
  errors.intensity = worst(original.intensity, decoded.intensity);
  errors.ring = worst(original.ring, decoded.ring);
  errors.time_ns = worst(original.time_ns, decoded.time_ns);
  return errors;
}

}  // namespace sweepcast::lab
