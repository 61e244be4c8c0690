#include "sweepcast/sensor_model.hpp"

#include <gtest/gtest.h>

#include "lab/real_sweeps.hpp"
#include "rounds.hpp"
#include "sensor/spinning_lidar.hpp"

namespace sweepcast {
namespace {

using test::made_up_model;
using test::sweep_of;

TEST(SensorModel, FindsItsMakerFromShuffledPoints) {
  std::mt19937 random(1);
  const SensorModel truth = made_up_model();
  const std::vector<PointCloud> clouds{sweep_of(truth, random), sweep_of(truth, random)};
  const std::vector<CloudView> views(clouds.begin(), clouds.end());
  const auto estimate = estimate_sensor_model(views);
  ASSERT_TRUE(estimate) << estimate.error().message;
  const SensorModel& model = estimate->model;
  ASSERT_EQ(model.beams.size(), truth.beams.size());
  EXPECT_EQ(model.ticks_per_turn, truth.ticks_per_turn);
  EXPECT_EQ(model.jitter, 0);
  const double tick_deg = 360.0 / truth.ticks_per_turn;
  const std::int32_t lag = truth.beams[0].lag - model.beams[0].lag;
  for (std::size_t k = 0; k < truth.beams.size(); ++k) {
    const Beam& a = truth.beams[k];
    const Beam& b = model.beams[k];
    EXPECT_NEAR(a.tan_elevation, b.tan_elevation, 1e-5 * kTangentUnits) << k;
    EXPECT_NEAR(a.height, b.height, 30) << k;
    EXPECT_NEAR(a.lateral_offset, b.lateral_offset, 30) << k;
    // The lag's zero, and with it a whole number of ticks, is anybody's choice.
    EXPECT_NEAR(a.azimuth_offset / 1e6 + (a.lag - lag) * tick_deg,
                b.azimuth_offset / 1e6 + b.lag * tick_deg, 0.002)
        << k;
  }
  EXPECT_EQ(estimate->residuals.points, clouds[0].size() + clouds[1].size());
  EXPECT_GT(estimate->residuals.share_5mm, 0.9999);
  EXPECT_LT(estimate->residuals.height_p99_m, 0.0005);
  EXPECT_TRUE(estimate->motions.empty());
}

TEST(SensorModel, TakesMillimetres) {
  std::mt19937 random(2);
  const SensorModel truth = made_up_model();
  const PointCloud cloud = sweep_of(truth, random, 0.001);
  const std::vector<CloudView> views{cloud};
  const auto estimate = estimate_sensor_model(views);
  ASSERT_TRUE(estimate) << estimate.error().message;
  EXPECT_EQ(estimate->model.beams.size(), truth.beams.size());
  EXPECT_EQ(estimate->model.ticks_per_turn, truth.ticks_per_turn);
  EXPECT_GT(estimate->residuals.share_5mm, 0.9999);
  EXPECT_LT(estimate->residuals.blur, 0.02);
}

TEST(SensorModel, RingsGiveTheSameAsNone) {
  std::mt19937 random(3);
  const SensorModel truth = made_up_model();
  PointCloud cloud = sweep_of(truth, random);
  const std::vector<CloudView> without{cloud};
  const auto blind = estimate_sensor_model(without);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double rho = std::hypot(cloud.x[i], cloud.y[i]);
    std::size_t ring = 0;
    double best = 1e9;
    for (std::size_t k = 0; k < truth.beams.size(); ++k) {
      const Beam& beam = truth.beams[k];
      const double miss = std::abs(cloud.z[i] - beam.height / 1e5 -
                                   rho * beam.tan_elevation / static_cast<double>(kTangentUnits));
      if (miss < best) {
        best = miss;
        ring = k;
      }
    }
    cloud.ring.push_back(static_cast<std::uint16_t>(40 - ring));  // numbered upward, with gaps
  }
  const std::vector<CloudView> with{cloud};
  const auto told = estimate_sensor_model(with);
  ASSERT_TRUE(blind && told);
  ASSERT_EQ(told->model.beams.size(), truth.beams.size());
  for (std::size_t k = 0; k < truth.beams.size(); ++k) {
    EXPECT_NEAR(told->model.beams[k].tan_elevation, blind->model.beams[k].tan_elevation, 50);
    EXPECT_EQ(told->model.beams[k].lag, blind->model.beams[k].lag);
  }
}

TEST(SensorModel, RefusesWhatDoesNotSpin) {
  std::mt19937 random(4);
  PointCloud box;
  for (int i = 0; i < test::rounds(20'000); ++i) {
    test::push(box, {test::uniform(random, -20, 20), test::uniform(random, -20, 20),
                     test::uniform(random, -20, 20)});
  }
  PointCloud camera;  // a depth camera: rows of pixels are no cones
  for (int v = -60; v < 60; ++v) {
    for (int u = -80; u < 80; ++u) {
      const double depth = 3.0 + std::sin(u / 20.0) + v / 60.0;
      test::push(camera, {depth, -u / 90.0 * depth, -v / 90.0 * depth});
    }
  }
  for (const PointCloud* cloud : {&box, &camera}) {
    const std::vector<CloudView> views{*cloud};
    const auto estimate = estimate_sensor_model(views);
    ASSERT_FALSE(estimate);
    EXPECT_EQ(estimate.error().code, ErrorCode::unsupported);
    EXPECT_NE(estimate.error().message.find("spinning LiDAR"), std::string::npos);
  }
}

TEST(SensorModel, RefusesTooLittle) {
  EXPECT_EQ(estimate_sensor_model({}).error().code, ErrorCode::invalid_argument);
  PointCloud few;
  for (int i = 0; i < 100; ++i) test::push(few, {i + 1.0, 0.0, 0.0});
  const std::vector<CloudView> views{few};
  EXPECT_EQ(estimate_sensor_model(views).error().code, ErrorCode::invalid_argument);
}

TEST(SensorModel, CheckNamesTheNumberAtFault) {
  const SensorModel sound = made_up_model();
  EXPECT_TRUE(check(sound));
  const auto message = [&](auto change) {
    SensorModel model = sound;
    change(model);
    const Status status = check(model);
    return status ? std::string("sound") : status.error().message;
  };
  EXPECT_NE(message([](SensorModel& m) { m.beams.clear(); }).find("0 beams"), std::string::npos);
  EXPECT_NE(message([](SensorModel& m) { m.ticks_per_turn = 0; }).find("ticks"), std::string::npos);
  EXPECT_NE(message([](SensorModel& m) { m.beams[3].lag = 2001; }).find("beam 3: lag"),
            std::string::npos);
  EXPECT_NE(message([](SensorModel& m) { m.beams[4].height = 1'000'001; }).find("beam 4: height"),
            std::string::npos);
  EXPECT_NE(message([](SensorModel& m) { std::swap(m.beams[5], m.beams[6]); }).find("beam 6: not"),
            std::string::npos);
  EXPECT_NE(message([](SensorModel& m) { m.jitter = -1; }).find("jitter"), std::string::npos);
}

}  // namespace
}  // namespace sweepcast
