// Qualities between the levels of the ladder.
#include "rate/beam_quality.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sweepcast {
namespace {

TEST(BeamQuality, WholeLevelsAreTheLadders) {
  for (std::size_t level = 0; level < kBeamLevels.size(); ++level) {
    const BeamQuality quality = beam_quality(static_cast<double>(level));
    EXPECT_EQ(quality.step_m, kBeamLevels[level].step_m) << level;
    EXPECT_EQ(quality.tolerance_m, kBeamLevels[level].tolerance_m) << level;
  }
}

TEST(BeamQuality, CoarserLevelsHaveNoFinerStepAndNoSmallerTolerance) {
  BeamQuality before = beam_quality(kFinestLevel);
  for (double level = kFinestLevel; level <= kCoarsestLevel; level += 0.05) {
    const BeamQuality quality = beam_quality(level);
    EXPECT_EQ(quality.tolerance_m[0], 0.0);
    for (std::size_t i = 0; i < BeamQuality::kLayers; ++i) {
      EXPECT_GE(quality.step_m[i], 0.0002) << level;
      EXPECT_LE(quality.step_m[i], 5.0) << level;
      EXPECT_GE(quality.tolerance_m[i], before.tolerance_m[i]) << level << ", layer " << i;
      // Level 2 buys its thinning with finer steps than level 1 has.
      if (level < 1.0 || level > 2.1) {
        EXPECT_GE(quality.step_m[i], before.step_m[i]) << level << ", layer " << i;
      }
    }
    before = quality;
  }
}

TEST(BeamQuality, HalfwayIsTheGeometricMean) {
  const BeamQuality quality = beam_quality(3.5);
  EXPECT_NEAR(quality.step_m[2], std::sqrt(0.12 * 0.2), 1e-9);
  EXPECT_NEAR(quality.tolerance_m[3], std::sqrt(1.0 * 12.0), 1e-9);
  EXPECT_NEAR(beam_quality(-1.0).step_m[0], 0.02, 1e-12);
}

}  // namespace
}  // namespace sweepcast
