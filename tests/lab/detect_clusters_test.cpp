// The detector without weights, on scenes drawn by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "lab/detect/box_overlap.hpp"
#include "lab/detect/detector.hpp"
#include "lab/detect/l_shape.hpp"
#include "lab/random.hpp"

namespace sweepcast::lab {
namespace {

TEST(LShape, FindsTheRectangleOfTwoSides) {
  for (const double yaw : {0.0, 0.3, 0.8, 1.4}) {
    Random random(2);
    std::vector<Eigen::Vector2d> points;
    const auto add = [&](double u, double v) {
      points.emplace_back(20.0 + std::cos(yaw) * u - std::sin(yaw) * v + 0.01 * random.normal(),
                          5.0 + std::sin(yaw) * u + std::cos(yaw) * v + 0.01 * random.normal());
    };
    for (int i = 0; i <= 40; ++i) add(-2.0 + 0.1 * i, -0.9);
    for (int i = 0; i <= 18; ++i) add(-2.0, -0.9 + 0.1 * i);
    const Rectangle found = fit_l_shape(points);
    EXPECT_NEAR(found.yaw, yaw, 0.03);
    EXPECT_NEAR(found.along, 4.0, 0.1);
    EXPECT_NEAR(found.across, 1.8, 0.1);
    EXPECT_LT((found.centre - Eigen::Vector2d(20.0, 5.0)).norm(), 0.1);
  }
  EXPECT_EQ(fit_l_shape({}).along, 0.0);
}

// A road that rises, and upright sides that the sensor sees.
class Street {
 public:
  explicit Street(double slope) : slope_(slope) {
    for (double x = -40.0; x < 40.0; x += 0.3) {
      for (double y = -15.0; y < 15.0; y += 0.3) add(x, y, 0.0);
    }
  }
  void wall(double x0, double y0, double x1, double y1, double top) {
    const double length = std::hypot(x1 - x0, y1 - y0);
    for (double at = 0.0; at <= length; at += 0.1) {
      for (double z = 0.05; z <= top; z += 0.15) {
        add(x0 + (x1 - x0) * at / length, y0 + (y1 - y0) * at / length, z);
      }
    }
  }
  [[nodiscard]] const PointCloud& cloud() const { return cloud_; }
  [[nodiscard]] double ground(double x) const { return -1.73 + slope_ * x; }

 private:
  void add(double x, double y, double z) {
    cloud_.x.push_back(static_cast<float>(x));
    cloud_.y.push_back(static_cast<float>(y));
    cloud_.z.push_back(static_cast<float>(ground(x) + z));
  }
  double slope_;
  PointCloud cloud_;
};

TEST(ClusterDetector, FindsTheCarAndNothingElse) {
  for (const double slope : {0.0, 0.04}) {
    Street street(slope);
    street.wall(10.0, 4.0, 14.3, 4.0, 1.5);  // a car's right side and rear
    street.wall(10.0, 4.0, 10.0, 5.75, 1.5);
    street.wall(-30.0, 12.0, 30.0, 12.0, 6.0);  // a house
    street.wall(5.0, -6.0, 5.05, -6.0, 3.0);    // a pole
    street.wall(-8.0, -5.0, -8.0, -4.6, 1.7);   // somebody
    PointCloud cloud = street.cloud();
    cloud.x.push_back(std::numeric_limits<float>::quiet_NaN());
    cloud.y.push_back(0.0F);
    cloud.z.push_back(std::numeric_limits<float>::infinity());
    const auto detector = make_cluster_detector();
    ASSERT_TRUE(detector);
    const auto boxes = (*detector)->detect(cloud);
    ASSERT_TRUE(boxes) << boxes.error().message;
    ASSERT_EQ(boxes->size(), 1U) << slope;
    Box car;
    car.centre = {12.15, 4.875, street.ground(12.15) + 0.75};
    car.length = 4.3;
    car.width = 1.75;
    car.height = 1.5;
    EXPECT_EQ(boxes->front().label, "Car");
    EXPECT_GT(bev_iou(boxes->front(), car), 0.8);
    EXPECT_GT(iou_3d(boxes->front(), car), 0.7);
    EXPECT_GT(boxes->front().points, 100);
  }
}

TEST(ClusterDetector, CompletesACarWhoseRearAloneIsSeen) {
  Street street(0.0);
  street.wall(15.0, -0.9, 15.0, 0.9, 1.5);
  const auto boxes = (*make_cluster_detector())->detect(street.cloud());
  ASSERT_TRUE(boxes);
  ASSERT_EQ(boxes->size(), 1U);
  EXPECT_NEAR(boxes->front().centre.x(), 15.0 + 2.15, 0.3) << "it lies behind what is seen";
  EXPECT_NEAR(boxes->front().centre.y(), 0.0, 0.1);
  EXPECT_NEAR(std::abs(std::cos(boxes->front().yaw)), 1.0, 0.01);
}

TEST(ClusterDetector, AnEmptySweepHasNone) {
  EXPECT_TRUE((*make_cluster_detector())->detect({})->empty());
}

}  // namespace
}  // namespace sweepcast::lab
