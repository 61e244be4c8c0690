#include "rate/qoe.hpp"

#include <gtest/gtest.h>

#include <array>

namespace sweepcast {
namespace {

TEST(Qoe, IsEquationFive) {
  EXPECT_EQ(level_quality(0), 25.0);
  EXPECT_EQ(level_quality(5), 0.0);
  EXPECT_EQ(qoe({}), 0.0);
  // 25 + 15 + 20, less half of 0 + 3 + 4, less 10 + 5.
  const std::array<QoeSweep, 3> sweeps{{{25, 0}, {15, 3}, {20, 4}}};
  EXPECT_DOUBLE_EQ(qoe(sweeps), 60.0 - 3.5 - 15.0);
}

}  // namespace
}  // namespace sweepcast
