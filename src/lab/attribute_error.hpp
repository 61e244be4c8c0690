// How far a decoded cloud's attributes are from the original's.
#pragma once

#include <optional>

#include "sweepcast/cloud.hpp"

namespace sweepcast::lab {

/// The worst difference of each attribute that both clouds have; empty where one has it not, or no
/// points are compared.
struct AttributeErrors {
  std::optional<double> intensity;  ///< the sensor's own unit
  std::optional<double> ring;
  std::optional<double> time_ns;

  /// Takes the worse of both.
  void add(const AttributeErrors& other);
};

/// Compares attributes. With `same_order` the points of both clouds, those left out that are not
/// finite or at the origin, are pairs one by one, if they are equally many. Otherwise each original
/// point's partner is the nearest decoded one: where points decode farther from their places than
/// they lie apart, that may be another point's.
[[nodiscard]] AttributeErrors attribute_errors(const PointCloud& original,
                                               const PointCloud& decoded, bool same_order);

}  // namespace sweepcast::lab
