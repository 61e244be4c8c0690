// The simulated sensors: their beams, firings, ranges and noise.
#include "lab/simulate/sensors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "lab/drives.hpp"
#include "lab/random.hpp"

namespace sweepcast::lab {
namespace {

// A beam's origin and direction at an azimuth tick, by the documented formula and libm.
struct Ray {
  Vec3 origin, direction;
};
Ray ray_of(const Sensor& sensor, int ring, int tick) {
  const Beam& beam = sensor.beams[static_cast<std::size_t>(ring)];
  const double radians = ((tick + beam.lag_ticks) * sensor.tick_deg() + beam.azimuth_offset_deg) *
                         std::acos(-1.0) / 180.0;
  const double c = std::cos(radians);
  const double s = std::sin(radians);
  return {{-beam.lateral_m * s, beam.lateral_m * c, beam.height_m},
          normalized({c, s, beam.tan_elevation})};
}

// The firing of each pulse of a sweep, by its time and ring.
std::map<std::pair<std::int64_t, int>, std::int64_t> firings(const Sensor& sensor, int sweep) {
  std::map<std::pair<std::int64_t, int>, std::int64_t> found;
  const std::int64_t first = sensor.first_firing(sweep);
  for (std::int64_t f = first; f < sensor.first_firing(sweep + 1); ++f) {
    for (int ring = 0; ring < static_cast<int>(sensor.beams.size()); ++ring) {
      const std::int64_t delay = sensor.beams[static_cast<std::size_t>(ring)].delay_ns;
      found[{sensor.time_ns(f) - sensor.time_ns(first) + delay, ring}] = f;
    }
  }
  return found;
}

// Nearest intersection by testing every triangle (Moeller and Trumbore 1997).
std::optional<double> brute_force(const Mesh& mesh, Vec3 origin, Vec3 direction) {
  std::optional<double> nearest;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertex(t[0]);
    const Vec3 ab = mesh.vertex(t[1]) - a;
    const Vec3 ac = mesh.vertex(t[2]) - a;
    const Vec3 p = cross(direction, ac);
    const double det = dot(ab, p);
    if (std::abs(det) < 1e-12) continue;
    const Vec3 s = origin - a;
    const double u = dot(s, p) / det;
    if (u < -1e-9 || u > 1.0 + 1e-9) continue;
    const Vec3 q = cross(s, ab);
    const double v = dot(direction, q) / det;
    if (v < -1e-9 || u + v > 1.0 + 1e-9) continue;
    const double range = dot(ac, q) / det;
    if (range > 1e-6 && (!nearest || range < *nearest)) nearest = range;
  }
  return nearest;
}

TEST(Simulate, RangesAreThoseOfTheNearestTriangle) {
  const Drive& drive = exact_vlp16();
  const Sensor& sensor = drive.sensor();
  const SimulatedSweep sweep = sweep_of(drive, 1);
  const auto fired = firings(sensor, 1);
  Random random(11);
  for (int n = 0; n < 60; ++n) {
    const auto i = static_cast<std::size_t>(random.below(static_cast<int>(sweep.cloud.size())));
    const int ring = sweep.cloud.ring[i];
    const std::int64_t time = sweep.cloud.time_ns[i];
    const Ray ray = ray_of(sensor, ring, sensor.azimuth_tick(fired.at({time, ring})));
    const Pose pose = drive.sensor_pose(begin_ns(drive, 1) + time);
    const auto expected =
        brute_force(drive.world(), pose.apply(ray.origin), pose.rotate(ray.direction));
    ASSERT_TRUE(expected);
    EXPECT_NEAR(length(point(sweep.cloud, i) - ray.origin), *expected,
                0.5 * sensor.range_step_m + 1e-5);
  }
}

TEST(Simulate, RangeNoiseIsTheSensors) {
  const SimulatedSweep exact = sweep_of(exact_vlp16(), 0);
  const Drive noisy = make_drive("vlp16", 1, false, 1.0, false);
  const SimulatedSweep sweep = sweep_of(noisy, 0);
  const double sigma = noisy.sensor().range_sigma_m;
  ASSERT_EQ(sweep.cloud.size(), exact.cloud.size());
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < sweep.cloud.size(); ++i) {
    ASSERT_EQ(sweep.cloud.ring[i], exact.cloud.ring[i]);
    const double error = length(point(sweep.cloud, i)) - length(point(exact.cloud, i));
    ASSERT_LT(std::abs(error), 6.0 * sigma + 2.0 * noisy.sensor().range_step_m);
    sum += error;
    squares += error * error;
  }
  const double count = static_cast<double>(sweep.cloud.size());
  EXPECT_NEAR(sum / count, 0.0, 5.0 * sigma / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(squares / count), sigma, 0.05 * sigma);
}

class EverySensor : public testing::TestWithParam<const char*> {};

TEST_P(EverySensor, PointsObeyTheBeamTable) {
  const Drive drive = make_drive(GetParam());
  const Sensor& sensor = drive.sensor();
  const SimulatedSweep sweep = sweep_of(drive, 1);
  const auto fired = firings(sensor, 1);
  const double rounding = sensor.millimetres ? 0.0011 : 0.0001;
  ASSERT_GT(sweep.cloud.size(), sensor.beams.size() * 500);
  for (std::size_t i = 0; i < sweep.cloud.size(); ++i) {
    ASSERT_LT(sweep.cloud.ring[i], sensor.beams.size());
    const int ring = sweep.cloud.ring[i];
    const Beam& beam = sensor.beams[sweep.cloud.ring[i]];
    const Vec3 p = point(sweep.cloud, i);
    const double rho = std::hypot(p.x, p.y);
    ASSERT_NEAR(p.z, rho * beam.tan_elevation + beam.height_m, rounding);
    const auto firing = fired.find({sweep.cloud.time_ns[i], ring});
    ASSERT_NE(firing, fired.end()) << "no such pulse";
    const Vec3 along = ray_of(sensor, ring, sensor.azimuth_tick(firing->second)).direction;
    const double sideways = (along.x * p.y - along.y * p.x) / std::hypot(along.x, along.y);
    ASSERT_NEAR(sideways, beam.lateral_m, rounding);
    ASSERT_GT(along.x * p.x + along.y * p.y, 0.0);
  }
}

TEST_P(EverySensor, PointsComeInTheSensorsOrder) {
  const Drive drive = make_drive(GetParam());
  const PointCloud cloud = sweep_of(drive, 0).cloud;
  const auto azimuth = [&](std::size_t i) {
    const double angle = std::atan2(cloud.y[i], cloud.x[i]);
    return angle < 0.0 ? angle + 2.0 * std::acos(-1.0) : angle;
  };
  for (std::size_t i = 1; i < cloud.size(); ++i) {
    if (!drive.sensor().ring_major) {
      ASSERT_GE(cloud.time_ns[i], cloud.time_ns[i - 1]);
    } else if (cloud.ring[i] == cloud.ring[i - 1]) {
      ASSERT_GE(azimuth(i), azimuth(i - 1) - 1e-6);
    } else {
      ASSERT_EQ(cloud.ring[i], cloud.ring[i - 1] + 1);
    }
  }
  const auto [first, last] = std::minmax_element(cloud.time_ns.begin(), cloud.time_ns.end());
  EXPECT_GE(*first, 0);
  EXPECT_GT(*last, 95'000'000);
  EXPECT_LE(*last, 100'100'000);
}

INSTANTIATE_TEST_SUITE_P(Sensors, EverySensor, testing::Values("hdl64", "vlp16", "os1-128"));

TEST(Simulate, Hdl64IsAsFullAsARealOne) {
  const Sensor& sensor = noisy_hdl64().sensor();
  for (int i = 0; i < 3; ++i) {
    const auto cells =
        static_cast<double>(64 * (sensor.first_firing(i + 1) - sensor.first_firing(i)));
    const double filled = static_cast<double>(sweep_of(noisy_hdl64(), i).cloud.size()) / cells;
    EXPECT_GT(filled, 0.80);
    EXPECT_LT(filled, 0.95);
  }
}

TEST(Simulate, Hdl64FiresAsItsEncoderTicks) {
  const Sensor& sensor = noisy_hdl64().sensor();
  const std::int64_t first = sensor.first_firing(7);
  EXPECT_NEAR(static_cast<double>(sensor.first_firing(8) - first), 2166.4, 1.0);
  int ones = 0;
  for (std::int64_t f = first; f < first + 2000; ++f) {
    const int step = (sensor.azimuth_tick(f) - sensor.azimuth_tick(f + 1) + 4000) % 4000;
    ASSERT_TRUE(step == 1 || step == 2);
    ones += step == 1 ? 1 : 0;
  }
  EXPECT_NEAR(ones / 2000.0, 1.0 / 6.5, 0.01);
}

}  // namespace
}  // namespace sweepcast::lab
