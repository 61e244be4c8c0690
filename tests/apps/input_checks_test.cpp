#include "common/input_checks.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace sweepcast::app {
namespace {

PointCloud with_intensities(std::vector<float> intensities) {
  PointCloud cloud;
  cloud.resize_xyz(intensities.size());
  cloud.intensity = std::move(intensities);
  return cloud;
}

TEST(InputChecks, NameDroppedFieldsOnceInTheirOrder) {
  InputChecks checks;
  checks.add("a.pcd", {}, {"rgb", "label"});
  EXPECT_EQ(checks.warnings().size(), 1U);
  checks.add("b.pcd", {}, {"normal_x", "rgb"});
  EXPECT_EQ(checks.dropped_fields(), (std::vector<std::string>{"rgb", "label", "normal_x"}));
  ASSERT_EQ(checks.warnings().size(), 1U);
  EXPECT_NE(checks.warnings().front().find("rgb, label, normal_x"), std::string::npos);
}

TEST(InputChecks, InterpolatedPointsAreToldOf) {
  PointCloud cloud = with_intensities({1, 2});
  cloud.filled = {0, 1};
  InputChecks checks;
  checks.add("a.pcd", cloud, {});
  EXPECT_EQ(checks.dropped_fields(), std::vector<std::string>{"filled"});
}

TEST(InputChecks, HalfOfThePointsFarAwayIsPlausibleAndMoreIsNot) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  PointCloud cloud;
  cloud.x = {1, 2, -1001, kInfinity};
  cloud.y = {0, 1000, 0, 0};
  cloud.z = {0, 0, 0, 0};
  InputChecks checks;
  checks.add("a.bin", cloud, {});
  EXPECT_TRUE(checks.warnings().empty());
  cloud.z[0] = 5000;
  checks.add("b.bin", cloud, {});
  ASSERT_EQ(checks.warnings().size(), 1U);
  EXPECT_NE(checks.warnings().front().find("5 of 8 points"), std::string::npos);
}

TEST(InputChecks, SlotsWithoutReturnArePlausibleInAPcd) {
  PointCloud cloud;
  cloud.x = cloud.y = cloud.z = {std::numeric_limits<float>::quiet_NaN(), 1};
  cloud.z[1] = std::numeric_limits<float>::quiet_NaN();
  InputChecks checks;
  checks.add("a.pcd", cloud, {});
  EXPECT_TRUE(checks.warnings().empty());
  checks.add("a.bin", cloud, {});
  EXPECT_TRUE(checks.warnings().empty());  // half of them
  checks.add("b.bin", cloud, {});
  EXPECT_EQ(checks.warnings().size(), 1U);
}

TEST(IntensityStep, MayNotBeWiderThanTheIntensities) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const PointCloud unit = with_intensities({0.5F, kNan, 0.0F, 0.75F});
  EXPECT_TRUE(check_intensity_step(unit, 0.0));
  EXPECT_TRUE(check_intensity_step(unit, 0.75));
  const Status refused = check_intensity_step(unit, 1.0);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_argument);
  EXPECT_NE(refused.error().message.find("0 to 0.75"), std::string::npos);
  EXPECT_TRUE(check_intensity_step(with_intensities({0, 100, 255}), 1.0));
}

TEST(IntensityStep, OfOneValueIsThatValueAtMost) {
  EXPECT_TRUE(check_intensity_step(with_intensities({7, 7}), 7.0));
  EXPECT_FALSE(check_intensity_step(with_intensities({7, 7}), 8.0));
  EXPECT_TRUE(check_intensity_step(with_intensities({0, 0}), 8.0));
  EXPECT_TRUE(check_intensity_step(with_intensities({}), 8.0));
  EXPECT_TRUE(
      check_intensity_step(with_intensities({std::numeric_limits<float>::infinity()}), 1.0));
}

}  // namespace
}  // namespace sweepcast::app
