// The figures of a comparison as JSON; the same keys wherever they are printed.
#pragma once

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "lab/distortion.hpp"

namespace sweepcast::app {

/// A number, or null where it is NaN or infinite, which JSON does not know.
[[nodiscard]] inline nlohmann::ordered_json number_or_null(double value) {
  if (!std::isfinite(value)) return nullptr;
  return value;
}

/// A count: without a fraction where it has none, as in a single comparison.
[[nodiscard]] inline nlohmann::ordered_json count_or_mean(double value) {
  if (value == std::floor(value)) return static_cast<std::int64_t>(value);
  return value;
}

/// Adds every figure under its name, and the object `f_score`.
inline void add_distortion(nlohmann::ordered_json& object, const lab::Distortion& distortion) {
  for (const lab::DistortionFigure& figure : lab::kDistortionFigures) {
    const double value = distortion.*figure.value;
    object[std::string(figure.name)] =
        figure.is_count ? count_or_mean(value) : number_or_null(value);
  }
  auto& f_score = object["f_score"];
  for (std::size_t k = 0; k < lab::kFScoreNames.size(); ++k) {
    f_score[std::string(lab::kFScoreNames[k])] = distortion.f_score[k];
  }
}

}  // namespace sweepcast::app
