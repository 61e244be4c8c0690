// Overlap of boxes and average precision, against answers found by other routes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lab/detect/average_precision.hpp"
#include "lab/detect/box_overlap.hpp"
#include "lab/random.hpp"

namespace sweepcast::lab {
namespace {

Box box_at(double x, double y, double yaw = 0.0, double score = 1.0) {
  Box box;
  box.centre = {x, y, -1.0};
  box.length = 4.0;
  box.width = 2.0;
  box.height = 1.5;
  box.yaw = yaw;
  box.score = score;
  return box;
}

bool holds(const Box& box, double x, double y) {
  const double dx = x - box.centre.x(), dy = y - box.centre.y();
  return std::abs(std::cos(box.yaw) * dx + std::sin(box.yaw) * dy) <= 0.5 * box.length &&
         std::abs(std::cos(box.yaw) * dy - std::sin(box.yaw) * dx) <= 0.5 * box.width;
}

// A lattice turned against both boxes, so that its error is that of random points, and less.
double counted_area(const Box& a, const Box& b) {
  constexpr double kStep = 0.01;
  int both = 0;
  for (double u = -4.0; u < 4.0; u += kStep) {
    for (double v = -4.0; v < 4.0; v += kStep) {
      const double x = a.centre.x() + 0.8 * u - 0.6 * v, y = a.centre.y() + 0.6 * u + 0.8 * v;
      both += holds(a, x, y) && holds(b, x, y) ? 1 : 0;
    }
  }
  return both * kStep * kStep;
}

TEST(BoxOverlap, IsWhatCountingFinds) {
  Random random(3);
  int overlapping = 0;
  for (int i = 0; i < 12; ++i) {
    Box a = box_at(random.uniform(-50.0, 50.0), 20.0, random.uniform(-4.0, 4.0));
    Box b = box_at(a.centre.x() + random.uniform(-2.0, 2.0), 20.0 + random.uniform(-2.0, 2.0),
                   random.uniform(-4.0, 4.0));
    b.length = random.uniform(1.0, 5.0);
    const double shared = shared_area(a, b);
    EXPECT_NEAR(shared, counted_area(a, b), 0.02);
    EXPECT_NEAR(shared, shared_area(b, a), 1e-9);
    overlapping += shared > 0.5 ? 1 : 0;
  }
  EXPECT_GE(overlapping, 6);
}

TEST(BoxOverlap, KnowsThePlainCases) {
  const Box box = box_at(1e4, -1e4, 0.3);
  EXPECT_NEAR(bev_iou(box, box), 1.0, 1e-9);
  EXPECT_NEAR(bev_iou(box_at(0, 0), box_at(1, 0)), 3.0 / 5.0, 1e-12);
  EXPECT_NEAR(bev_iou(box_at(0, 0), box_at(0, 0, std::numbers::pi / 2)), 4.0 / 12.0, 1e-12);
  EXPECT_EQ(bev_iou(box_at(0, 0), box_at(4.01, 0)), 0.0);
  EXPECT_EQ(bev_iou(box_at(0, 0), box_at(100, 0)), 0.0);
  Box higher = box_at(0, 0);
  higher.centre.z() += 0.5;
  EXPECT_NEAR(iou_3d(box_at(0, 0), higher), 1.0 / 2.0, 1e-12);
  higher.centre.z() += 2.0;
  EXPECT_EQ(iou_3d(box_at(0, 0), higher), 0.0);
  // A square and the same turned by 45 degrees have an octagon in common.
  Box square = box_at(0, 0);
  square.length = 2.0;
  Box turned = square;
  turned.yaw = std::numbers::pi / 4;
  EXPECT_NEAR(shared_area(square, turned), 8.0 * (std::numbers::sqrt2 - 1.0), 1e-9);
}

TEST(AveragePrecision, OfCurvesDrawnByHand) {
  EXPECT_EQ(average_precision({}, 3, 40), 0.0);
  EXPECT_EQ(average_precision({{0.9, true}}, 0, 40), 0.0);
  EXPECT_DOUBLE_EQ(average_precision({{0.9, true}, {0.8, true}}, 2, 40), 1.0);
  EXPECT_DOUBLE_EQ(average_precision({{0.9, true}, {0.8, true}}, 2, 11), 1.0);
  // Right, wrong, right of four: precision 1 to recall 1/4, 2/3 to 1/2, then nothing.
  const std::vector<Judged> three{{0.7, true}, {0.9, true}, {0.8, false}};
  EXPECT_NEAR(average_precision(three, 4, 40), (10 * 1.0 + 10 * 2.0 / 3.0) / 40, 1e-12);
  EXPECT_NEAR(average_precision(three, 4, 11), (3 * 1.0 + 3 * 2.0 / 3.0) / 11, 1e-12);
  // A wrong one first, then four right: the precision of the end, 4/5, counts everywhere.
  EXPECT_NEAR(average_precision({{5, false}, {4, true}, {3, true}, {2, true}, {1, true}}, 4, 40),
              0.8, 1e-12);
  // Of equal scores neither goes first.
  EXPECT_NEAR(average_precision({{1, true}, {1, false}}, 1, 40), 0.5, 1e-12);
  EXPECT_NEAR(average_precision({{1, false}, {1, true}}, 1, 40), 0.5, 1e-12);
}

TEST(DetectionScore, IsFullForTheTruthAndNothingWithout) {
  const std::vector<std::vector<Box>> truth{{box_at(10, 0), box_at(20, 5, 1.0)}, {box_at(-8, 3)}};
  const DetectionScore full = detection_score(truth, truth);
  EXPECT_DOUBLE_EQ(full.bev_ap50, 100.0);
  EXPECT_DOUBLE_EQ(full.bev_ap70, 100.0);
  EXPECT_DOUBLE_EQ(full.ap50_3d, 100.0);
  EXPECT_DOUBLE_EQ(full.ap70_3d, 100.0);
  const std::vector<std::vector<Box>> none(2);
  EXPECT_EQ(detection_score(truth, none).bev_ap50, 0.0);
  EXPECT_EQ(detection_score(none, truth).bev_ap50, 0.0);
}

TEST(DetectionScore, ThresholdsAndHeightCount) {
  const std::vector<std::vector<Box>> truth{{box_at(10, 0)}};
  std::vector<std::vector<Box>> found{{box_at(11, 0)}};  // IoU 0.6
  DetectionScore score = detection_score(truth, found);
  EXPECT_DOUBLE_EQ(score.bev_ap50, 100.0);
  EXPECT_DOUBLE_EQ(score.bev_ap70, 0.0);
  EXPECT_DOUBLE_EQ(score.ap50_3d, 100.0);
  found[0][0].centre.z() += 0.5;
  score = detection_score(truth, found);
  EXPECT_DOUBLE_EQ(score.bev_ap50, 100.0);
  EXPECT_DOUBLE_EQ(score.ap50_3d, 0.0);
}

TEST(DetectionScore, WhatDoesNotCountIsNeitherRightNorWrong) {
  Box van = box_at(10, 10), sparse = box_at(-10, 10), far = box_at(60, 0), person = box_at(5, -9);
  van.label = "Van";
  sparse.points = 9;
  person.label = "Pedestrian";
  const std::vector<std::vector<Box>> truth{{box_at(10, 0), van, sparse, far, person}};
  std::vector<Box> found{box_at(10, 0, 0, 0.5), box_at(10, 10), box_at(-10, 10), box_at(60, 0),
                         box_at(70, 9)};
  Box other = box_at(30, 30);
  other.label = "Van";  // another class's box
  found.push_back(other);
  const std::vector<std::vector<Box>> all{found};
  EXPECT_DOUBLE_EQ(detection_score(truth, all).bev_ap70, 100.0);
  found.push_back(box_at(5, -9));  // a person is no car
  const std::vector<std::vector<Box>> wrong{found};
  EXPECT_DOUBLE_EQ(detection_score(truth, wrong).bev_ap70, 50.0);
  ScoreOptions strict;
  strict.min_points = 0;
  EXPECT_DOUBLE_EQ(detection_score(truth, all, strict).bev_ap70, 100.0);
}

TEST(DetectionScore, ASecondBoxOnTheSameCarIsWrong) {
  const std::vector<std::vector<Box>> truth{{box_at(10, 0)}};
  const std::vector<std::vector<Box>> found{{box_at(10.1, 0, 0, 0.9), box_at(10, 0, 0, 0.8)}};
  EXPECT_DOUBLE_EQ(detection_score(truth, found).bev_ap70, 100.0);  // found before the wrong one
  const std::vector<std::vector<Box>> other{
      {box_at(10, 0, 0, 0.8), box_at(30, 0, 0, 0.9), box_at(10, 0, 0, 0.7)}};
  EXPECT_DOUBLE_EQ(detection_score(truth, other).bev_ap70, 50.0);
}

}  // namespace
}  // namespace sweepcast::lab
