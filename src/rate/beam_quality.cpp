#include "rate/beam_quality.hpp"

#include <algorithm>
#include <cmath>

namespace sweepcast {
namespace {

constexpr double kLastLevel = static_cast<double>(kBeamLevels.size()) - 1.0;
constexpr double kNoTolerance = 0.01;  // metres: what a tolerance of 0 counts as between levels
constexpr double kAnything = 1000.0;   // metres

double between(double a, double b, double part) {
  return a * std::pow(b / a, part);
}

BeamQuality scaled(BeamQuality quality, double factor) {
  for (double& step : quality.step_m) step = std::clamp(step * factor, 0.0002, 5.0);
  return quality;
}

}  // namespace

BeamQuality beam_quality(double level) {
  if (level <= 0.0) return scaled(kBeamLevels.front(), std::exp2(level));
  if (level >= kLastLevel) {
    BeamQuality quality = scaled(kBeamLevels.back(), std::exp2((level - kLastLevel) / 2.0));
    for (std::size_t i = 1; i < BeamQuality::kLayers && level > kLastLevel; ++i) {
      double& tolerance = quality.tolerance_m[i];
      tolerance = between(tolerance, kAnything, std::min(1.0, level - kLastLevel));
    }
    return quality;
  }
  const auto finer = static_cast<std::size_t>(level);
  const double part = level - static_cast<double>(finer);
  BeamQuality quality = kBeamLevels[finer];
  if (part == 0.0) return quality;
  const BeamQuality& coarser = kBeamLevels[finer + 1];
  for (std::size_t i = 0; i < BeamQuality::kLayers; ++i) {
    quality.step_m[i] = between(quality.step_m[i], coarser.step_m[i], part);
    if (coarser.tolerance_m[i] == 0.0) continue;
    quality.tolerance_m[i] =
        between(std::max(quality.tolerance_m[i], kNoTolerance), coarser.tolerance_m[i], part);
  }
  return quality;
}

}  // namespace sweepcast
