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

/// Compares attributes of clouds in the same order: the points of both, those left out that are not
/// finite or at the origin, are pairs one by one. Nothing is compared where they are not as many.
[[nodiscard]] AttributeErrors attribute_errors(const PointCloud& original,
                                               const PointCloud& decoded);

}  // namespace sweepcast::lab
