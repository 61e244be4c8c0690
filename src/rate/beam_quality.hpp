// Qualities of codec `beam` between the levels of its ladder.
#pragma once

#include "sweepcast/ladder.hpp"

namespace sweepcast {

inline constexpr double kFinestLevel = -5.0;
inline constexpr double kCoarsestLevel = 12.0;

/// The quality at a level from kFinestLevel to kCoarsestLevel. Whole levels from 0 to 5 are those
/// of `kBeamLevels`; between them steps and tolerances change geometrically; finer ones halve the
/// steps a level, coarser ones leave out all that interpolation can replace and double the steps
/// every second level. Steps lie between 0.2 mm and 5 m.
[[nodiscard]] BeamQuality beam_quality(double level);

}  // namespace sweepcast
