// Places of the lattice within the error bound.
#include "codec/beam/place_choice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "core/random.hpp"
#include "sweepcast/cloud.hpp"

namespace sweepcast::beam {
namespace {

using test::uniform;

constexpr double kError = 0.05;
constexpr double kStep = 0.0577;  // half a cube's diagonal is the bound

/// A wall and a floor with noise, and a few points far away.
PointCloud corner(int points) {
  std::mt19937 random(7);
  PointCloud cloud;
  for (int i = 0; i < points; ++i) {
    const double noise = uniform(random, -0.01, 0.01);
    const double along = uniform(random, -2, 2);
    const double across = uniform(random, 0, 2);
    const bool wall = i % 2 == 0;
    cloud.x.push_back(static_cast<float>(i % 100 == 0 ? 50 * along : along));
    cloud.y.push_back(static_cast<float>(wall ? 1.03 + noise : across));
    cloud.z.push_back(static_cast<float>(wall ? across : -0.41 + noise));
  }
  return cloud;
}

std::vector<LatticePoint> chosen(const PointCloud& cloud) {
  std::vector<LatticePoint> places;
  choose_places(cloud.x, cloud.y, cloud.z, kStep, kError, places);
  return places;
}

std::map<LatticePoint, int> count(const std::vector<LatticePoint>& places) {
  std::map<LatticePoint, int> counts;
  for (const LatticePoint& place : places) ++counts[place];
  return counts;
}

TEST(PlaceChoice, EveryPointStaysWithinTheBound) {
  const PointCloud cloud = corner(5000);
  const std::vector<LatticePoint> places = chosen(cloud);
  ASSERT_EQ(places.size(), cloud.size());
  PointCloud decoded;
  append_places(places, kStep, decoded);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_LE(std::hypot(double{decoded.x[i]} - double{cloud.x[i]},
                         double{decoded.y[i]} - double{cloud.y[i]},
                         double{decoded.z[i]} - double{cloud.z[i]}),
              kError)
        << i;
  }
}

TEST(PlaceChoice, FewerPlacesAreTakenThanAreNearest) {
  const PointCloud cloud = corner(20'000);
  std::vector<LatticePoint> nearest(cloud.size());
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    ASSERT_TRUE(nearest_place({cloud.x[i], cloud.y[i], cloud.z[i]}, kStep, nearest[i]));
  }
  EXPECT_LT(count(chosen(cloud)).size() * 5, count(nearest).size() * 4);
}

TEST(PlaceChoice, NumbersOfPointsAreRound) {
  int round = 0;
  int many = 0;
  for (const auto& [place, points] : count(chosen(corner(40'000)))) {
    if (points < 8) continue;
    ++many;
    if (std::has_single_bit(static_cast<unsigned>(points))) ++round;
  }
  ASSERT_GT(many, 500);
  EXPECT_GT(round * 3, many);  // one in four would be, were they drawn from 8 to 15
}

TEST(PlaceChoice, TheLatticeHasAnEnd) {
  LatticePoint place{};
  EXPECT_TRUE(nearest_place({1e6, -1e6, 0.4}, 1.0, place));
  EXPECT_EQ(place, (LatticePoint{1'000'000, -1'000'000, 0}));
  EXPECT_FALSE(nearest_place({1.1e6, 0, 0}, 1.0, place));
  EXPECT_FALSE(nearest_place({0, std::nan(""), 0}, 1.0, place));
  PointCloud edge;  // its nearest place is the last that there is
  edge.x = {static_cast<float>((kLatticeLimit - 1) * kStep)};
  edge.y = {0.0F};
  edge.z = {0.0F};
  EXPECT_EQ(chosen(edge).front()[0], kLatticeLimit - 1);
  EXPECT_TRUE(chosen(PointCloud{}).empty());
}

}  // namespace
}  // namespace sweepcast::beam
