#include "lab/attribute_error.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lab/point_tree.hpp"

namespace sweepcast::lab {
namespace {

using Eigen::Vector3d;

Vector3d place(const PointCloud& cloud, std::size_t i) {
  return {cloud.x[i], cloud.y[i], cloud.z[i]};
}

// Indices of the points that are finite and not at the origin.
std::vector<std::size_t> usable(const PointCloud& cloud) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3d at = place(cloud, i);
    if (at.allFinite() && !at.isZero(0.0)) indices.push_back(i);
  }
  return indices;
}

// Of each original point its partner among the decoded ones.
std::vector<std::size_t> nearest_partners(const PointCloud& original,
                                          const std::vector<std::size_t>& from,
                                          const PointCloud& decoded,
                                          const std::vector<std::size_t>& to) {
  std::vector<Vector3d> points;
  points.reserve(to.size());
  for (const std::size_t i : to) points.push_back(place(decoded, i));
  const PointTree tree(points);
  std::vector<std::size_t> partners;
  partners.reserve(from.size());
  for (const std::size_t i : from) partners.push_back(to[tree.nearest(place(original, i))]);
  return partners;
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

AttributeErrors attribute_errors(const PointCloud& original, const PointCloud& decoded,
                                 bool same_order) {
  const std::vector<std::size_t> from = usable(original);
  std::vector<std::size_t> partners = usable(decoded);
  AttributeErrors errors;
  const bool any = (original.has_intensity() && decoded.has_intensity()) ||
                   (original.has_ring() && decoded.has_ring()) ||
                   (original.has_time() && decoded.has_time());
  if (!any || from.empty() || partners.empty()) return errors;
  if (!same_order || from.size() != partners.size()) {
    partners = nearest_partners(original, from, decoded, partners);
  }
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
