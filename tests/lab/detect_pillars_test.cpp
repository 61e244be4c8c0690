// What goes into the network, and what comes out of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "lab/detect/anchors.hpp"
#include "lab/detect/box_overlap.hpp"
#include "lab/detect/pillars.hpp"
#include "lab/detect/training_set.hpp"

namespace sweepcast::lab {
namespace {

constexpr double kPi = std::numbers::pi;

Box car_at(double x, double y, double yaw, int points = 50) {
  Box box;
  box.centre = {x, y, -0.9};
  box.length = 4.4;
  box.width = 1.8;
  box.height = 1.5;
  box.yaw = yaw;
  box.points = points;
  return box;
}

TEST(Pillars, HoldThePointsOfTheirCell) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  // Two in one pillar, one in the next row, and four that are nowhere.
  const std::vector<float> x{0.1F, 0.2F, 0.1F, 60.0F, kNan, 0.1F, 0.1F};
  const std::vector<float> y{0.1F, 0.1F, 0.5F, 0.0F, 0.0F, kNan, 0.1F};
  const std::vector<float> z{-1.0F, 0.0F, 0.5F, 0.0F, 0.0F, 0.0F, 9.0F};
  const Pillars pillars = make_pillars(x, y, z);
  const std::int64_t middle = PillarGrid::kSide / 2;
  EXPECT_EQ(pillars.cell, (std::vector<std::int64_t>{middle * PillarGrid::kSide + middle,
                                                     (middle + 1) * PillarGrid::kSide + middle}));
  EXPECT_EQ(pillars.owner, (std::vector<std::int64_t>{0, 0, 1}));
  ASSERT_EQ(pillars.features.size(), 3U * kPointFeatures);
  const float* second = pillars.features.data() + kPointFeatures;
  EXPECT_FLOAT_EQ(second[0], 0.2F / 51.2F);
  EXPECT_FLOAT_EQ(second[2], 0.0F);
  EXPECT_NEAR(second[3], 0.05 / 0.4, 1e-5) << "from the mean";
  EXPECT_NEAR(second[5], 0.5, 1e-5);
  EXPECT_NEAR(second[6], 0.0, 1e-4) << "from the pillar's middle";
}

TEST(Pillars, TakeCrowdsEvenly) {
  std::vector<float> x, y, z;
  for (int i = 0; i < 1000; ++i) {
    x.push_back(10.0F);
    y.push_back(10.0F);
    z.push_back(static_cast<float>(i) * 0.001F);
  }
  const Pillars pillars = make_pillars(x, y, z);
  EXPECT_EQ(pillars.cell.size(), 1U);
  EXPECT_LE(pillars.owner.size(), static_cast<std::size_t>(PillarGrid::kMostPoints));
  EXPECT_GT(pillars.owner.size(), static_cast<std::size_t>(PillarGrid::kMostPoints / 2));
  float highest = 0.0F;
  for (std::size_t i = 2; i < pillars.features.size(); i += kPointFeatures) {
    highest = std::max(highest, pillars.features[i]);
  }
  EXPECT_GT(highest, 0.45F) << "also of the last";
  EXPECT_TRUE(make_pillars({}, {}, {}).cell.empty());
}

TEST(Anchors, DecodingUndoesEncoding) {
  const std::vector<Box> boxes{car_at(10.3, -4.1, 0.1), car_at(-20.0, 7.7, kPi - 0.2),
                               car_at(3.0, 30.0, -kPi / 2), car_at(33.3, 33.3, 0.8)};
  const AnchorTargets targets = assign_targets(boxes, 5);
  ASSERT_EQ(targets.residuals.size(), targets.positive.size() * kResiduals);
  std::vector<int> found(boxes.size(), 0);
  for (std::size_t i = 0; i < targets.positive.size(); ++i) {
    const std::span<const float, kResiduals> own(targets.residuals.data() + i * kResiduals,
                                                 kResiduals);
    const Box box =
        decode_box(static_cast<int>(targets.positive[i]), own, targets.backward[i] == 1, 0.5);
    const auto same = std::find_if(boxes.begin(), boxes.end(), [&](const Box& other) {
      return (other.centre - box.centre).norm() < 1e-3 &&
             std::abs(other.length - box.length) < 1e-3 &&
             std::abs(std::remainder(other.yaw - box.yaw, 2.0 * kPi)) < 1e-3;
    });
    ASSERT_NE(same, boxes.end()) << targets.positive[i];
    ++found[static_cast<std::size_t>(same - boxes.begin())];
    EXPECT_EQ(targets.state[static_cast<std::size_t>(targets.positive[i])], 1.0F);
  }
  for (const int count : found) EXPECT_GE(count, 1) << "even where no anchor fits well";
  EXPECT_EQ(std::count(targets.state.begin(), targets.state.end(), 1.0F),
            static_cast<std::ptrdiff_t>(targets.positive.size()));
}

TEST(Anchors, StatesFollowTheOverlap) {
  const Box car = car_at(12.0, 5.0, 0.0);
  const Box sparse = car_at(-12.0, 5.0, 0.0, 2);
  Box person = car_at(0.0, 20.0, 0.0);
  person.label = "Pedestrian";
  const std::vector<Box> boxes{car, sparse, person};
  const AnchorTargets targets = assign_targets(boxes, 5);
  int between = 0;
  for (int index = 0; index < kAnchors; ++index) {
    const Box at = anchor(index);
    const float state = targets.state[static_cast<std::size_t>(index)];
    const double overlap = bev_iou(car, at);
    const double other = bev_iou(sparse, at);
    if (overlap >= 0.55) {
      EXPECT_EQ(state, 1.0F);
    }
    if (other >= 0.4) {
      EXPECT_EQ(state, -1.0F);
    }
    if (overlap < 0.4 && other < 0.4) {
      EXPECT_EQ(state, 0.0F) << index;
    }
    between += state == -1.0F ? 1 : 0;
  }
  EXPECT_GT(between, 4);
}

TEST(Anchors, OfOverlappingBoxesTheBestStays) {
  std::vector<Box> boxes{car_at(10, 0, 0), car_at(10.5, 0, 0), car_at(10, 2.5, 0)};
  boxes[0].score = 0.5;
  boxes[1].score = 0.9;
  boxes[2].score = 0.7;
  const auto kept = suppress_overlaps(boxes, 0.1);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[0].score, 0.9);
  EXPECT_NEAR(kept[0].centre.x(), (0.9 * 10.5 + 0.5 * 10.0) / 1.4, 1e-9) << "both have a say";
  EXPECT_EQ(kept[1].score, 0.7);
  EXPECT_NEAR(kept[1].centre.y(), 2.5, 1e-9);
}

TEST(TrainingSet, ExamplesAreChangedAndStayTrue) {
  // A car's sides as points: whatever the change, its box holds them.
  LabelledSweep sweep;
  const Box car = car_at(15.0, 4.0, 0.3);
  for (int i = -20; i <= 20; ++i) {
    for (const double side : {-0.8, 0.8}) {
      const double u = 0.1 * i, c = std::cos(car.yaw), s = std::sin(car.yaw);
      sweep.x.push_back(static_cast<float>(car.centre.x() + c * u - s * side));
      sweep.y.push_back(static_cast<float>(car.centre.y() + s * u + c * side));
      sweep.z.push_back(-0.9F);
    }
  }
  sweep.boxes = {car};
  Random random(5);
  double least = 1e9, most = -1e9;
  for (int i = 0; i < 40; ++i) {
    const Example example = make_example(sweep, random);
    ASSERT_FALSE(example.targets.positive.empty());
    const Box box =
        decode_box(static_cast<int>(example.targets.positive[0]),
                   std::span<const float, kResiduals>(example.targets.residuals.data(), kResiduals),
                   example.targets.backward[0] == 1, 1.0);
    PointCloud points;
    points.resize_xyz(example.pillars.owner.size());
    for (std::size_t p = 0; p < points.size(); ++p) {
      points.x[p] = example.pillars.features[p * kPointFeatures] * PillarGrid::kReach;
      points.y[p] = example.pillars.features[p * kPointFeatures + 1] * PillarGrid::kReach;
      points.z[p] = example.pillars.features[p * kPointFeatures + 2] * 2.0F;
    }
    std::vector<Box> counted{box};
    counted[0].length += 0.3;
    counted[0].width += 0.3;
    count_points(points, counted);
    EXPECT_GE(counted[0].points, static_cast<int>(points.size()) * 95 / 100);
    least = std::min(least, box.yaw);
    most = std::max(most, box.yaw);
  }
  EXPECT_GT(most - least, 3.0) << "turned";
}

}  // namespace
}  // namespace sweepcast::lab
