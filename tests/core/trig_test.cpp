#include "core/trig.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/random.hpp"

namespace sweepcast {
namespace {

using test::uniform;

TEST(Trig, SinCosAgreeWithTheStandardLibrary) {
  std::mt19937 random(1);
  double worst = 0.0;
  const auto check = [&](double angle) {
    const SinCos s = sin_cos(angle);
    worst = std::max({worst, std::abs(s.sin - std::sin(angle)), std::abs(s.cos - std::cos(angle))});
  };
  for (const double span : {1e-3, 1.0, 7.0, 1e3, 1e6}) {
    for (int i = 0; i < 20000; ++i) check(uniform(random, -span, span));
  }
  for (int quarter = -4000; quarter <= 4000; ++quarter) {  // where the octants meet
    const double angle = quarter * kPi / 4;
    check(angle);
    check(std::nextafter(angle, 1e9));
    check(std::nextafter(angle, -1e9));
  }
  EXPECT_LT(worst, 4e-16);
}

TEST(Trig, SinCosOfSpecialAngles) {
  EXPECT_EQ(sin_cos(0.0).sin, 0.0);
  EXPECT_EQ(sin_cos(0.0).cos, 1.0);
  EXPECT_EQ(sin_cos(kPi / 2).sin, 1.0);
  EXPECT_EQ(sin_cos(kPi).cos, -1.0);
  EXPECT_EQ(sin_cos(-kPi / 2).sin, -1.0);
  EXPECT_NEAR(sin_cos(kPi / 6).sin, 0.5, 2e-16);
  EXPECT_NEAR(sin_cos(30 * kDegree).sin, 0.5, 2e-16);
}

TEST(Trig, ArcTangentAgreesWithTheStandardLibrary) {
  std::mt19937 random(2);
  double worst = 0.0;
  for (int i = 0; i < 200000; ++i) {
    const double scale = std::pow(10.0, uniform(random, -12, 12));
    const double y = uniform(random, -1, 1) * scale;
    const double x = uniform(random, -1, 1);
    worst = std::max(worst, std::abs(arc_tangent(y, x) - std::atan2(y, x)));
  }
  EXPECT_LT(worst, 1e-15);
}

TEST(Trig, ArcTangentOnTheAxesAndInAllQuadrants) {
  EXPECT_EQ(arc_tangent(0, 0), 0.0);
  EXPECT_EQ(arc_tangent(0, 1), 0.0);
  EXPECT_EQ(arc_tangent(1, 0), kPi / 2);
  EXPECT_EQ(arc_tangent(0, -1), kPi);
  EXPECT_EQ(arc_tangent(-1, 0), -kPi / 2);
  for (const double y : {-2.0, 2.0}) {
    for (const double x : {-3.0, 3.0}) {
      EXPECT_NEAR(arc_tangent(y, x), std::atan2(y, x), 1e-15);
      EXPECT_NEAR(arc_tangent_fast(static_cast<float>(y), static_cast<float>(x)), std::atan2(y, x),
                  5e-7);
    }
  }
}

TEST(Trig, ArcTangentFastStaysWithinItsBound) {
  std::mt19937 random(3);
  double worst = 0.0;
  const auto check = [&](float y, float x) {
    worst = std::max(worst, std::abs(double{arc_tangent_fast(y, x)} - std::atan2(y, x)));
  };
  for (int i = 0; i < 400000; ++i) {
    const double angle = uniform(random, -kPi, kPi);
    const double radius = std::pow(10.0, uniform(random, -3, 3));
    check(static_cast<float>(radius * std::sin(angle)),
          static_cast<float>(radius * std::cos(angle)));
  }
  for (int i = 0; i <= 100000; ++i) {  // the polynomial's whole interval
    check(static_cast<float>(i) * 1e-5F, 1.0F);
    check(1.0F, static_cast<float>(i) * -1e-5F);
  }
  EXPECT_LT(worst, 5e-7);
}

TEST(Trig, ArcTangentFastIsFiniteForEveryFiniteInput) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  constexpr float kSmallest = std::numeric_limits<float>::denorm_min();
  for (const float y : {0.0F, -0.0F, kSmallest, -kSmallest, 1.0F, kLargest, -kLargest}) {
    for (const float x : {0.0F, -0.0F, kSmallest, -kSmallest, 1.0F, kLargest, -kLargest}) {
      EXPECT_LE(std::abs(arc_tangent_fast(y, x)), 3.1415930F) << y << ", " << x;
    }
  }
}

}  // namespace
}  // namespace sweepcast
