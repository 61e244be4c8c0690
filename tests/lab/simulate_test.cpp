// The drive as a whole: same bytes everywhere, its poses and its boxes.
#include "lab/simulate/simulate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <thread>
#include <vector>

#include "lab/drives.hpp"
#include "lab/random.hpp"
#include "lab/simulate/road.hpp"

namespace sweepcast::lab {
namespace {

// FNV-1a over the columns' bytes.
std::uint64_t fingerprint(const PointCloud& cloud) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  const auto add = [&](const auto& column) {
    for (const auto& value : column) {
      unsigned char bytes[sizeof(value)];
      std::memcpy(bytes, &value, sizeof(value));
      for (unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001B3ULL;
    }
  };
  add(cloud.x);
  add(cloud.y);
  add(cloud.z);
  add(cloud.intensity);
  add(cloud.ring);
  add(cloud.time_ns);
  return hash;
}

TEST(Simulate, GoldenBytes) {
  // Set down on x86-64 with g++ 12; any machine and compiler must give the same.
  EXPECT_EQ(fingerprint(sweep_of(noisy_hdl64(), 0).cloud), 0x7EACF331E39EF050ULL);
  EXPECT_EQ(fingerprint(sweep_of(noisy_hdl64(), 2).cloud), 0x4B5322D275EAA3D3ULL);
  EXPECT_EQ(fingerprint(sweep_of(exact_vlp16(), 1).cloud), 0x3E37E37B94200DC5ULL);
  EXPECT_EQ(fingerprint(sweep_of(make_drive("os1-128", 5), 1).cloud), 0xFE13A348AF243156ULL);
}

TEST(Simulate, SweepsDoNotDependOnOrderThreadsOrInstance) {
  const Drive again = make_drive("hdl64");
  std::vector<std::uint64_t> hashes(3);
  std::vector<std::thread> threads;
  for (int i = 2; i >= 0; --i) {
    threads.emplace_back(
        [&, i] { hashes[static_cast<std::size_t>(i)] = fingerprint(sweep_of(again, i).cloud); });
  }
  for (auto& thread : threads) thread.join();
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(hashes[static_cast<std::size_t>(i)], fingerprint(sweep_of(noisy_hdl64(), i).cloud));
  }
  EXPECT_NE(fingerprint(sweep_of(make_drive("hdl64", 2), 0).cloud), hashes[0]);
}

TEST(Simulate, DrivesAtTenMetresASecondRoundAClosedLoop) {
  const Drive& drive = noisy_hdl64();
  const auto sweeps = static_cast<int>(drive.loop_length());
  double turned = 0.0;
  for (int i = 0; i < sweeps; ++i) {
    const Pose a = drive.sweep_pose(i);
    const Pose b = drive.sweep_pose(i + 1);
    // Of the car; the sensor on its roof also swings as the car pitches and rolls.
    const double mast = drive.sensor().mount_height_m;
    const Vec3 step = (b.origin - b.z * mast) - (a.origin - a.z * mast);
    ASSERT_NEAR(std::hypot(step.x, step.y), 1.0, 0.002);
    ASSERT_LT(std::abs(step.z), 0.12);
    const Vec3 ahead = a.unrotate(b.x);
    ASSERT_LT(std::abs(ahead.y), 0.06);  // under 35 degrees a second
    turned += std::atan2(ahead.y, ahead.x);
    ASSERT_NEAR(dot(cross(a.x, a.y), a.z), 1.0, 1e-12);
  }
  EXPECT_NEAR(turned, 2.0 * std::acos(-1.0), 0.1);
  const Loop loop(3);
  const Loop::Place begin = loop.at(0.0);
  const Loop::Place end = loop.at(loop.length() * (1.0 - 1e-9));
  EXPECT_LT(std::hypot(end.x - begin.x, end.y - begin.y), 1e-4);
  EXPECT_NEAR(Loop(1).length(), 290.0, 15.0);
  EXPECT_NEAR(Loop(3).length(), 600.0, 15.0);
}

TEST(Simulate, PosesAreSensorToFirstSensor) {
  const Drive& drive = noisy_hdl64();
  const SimulatedSweep first = sweep_of(drive, 0);
  EXPECT_LT(length(first.pose.origin), 1e-12);
  const SimulatedSweep third = sweep_of(drive, 2);
  EXPECT_NEAR(third.pose.origin.x, 2.0, 0.02);
  const Vec3 p{3.0, -2.0, 1.0};
  const Vec3 world = drive.sweep_pose(2).apply(p);
  EXPECT_LT(length(drive.sweep_pose(0).apply(third.pose.apply(p)) - world), 1e-12);
}

TEST(Simulate, BoxesHoldThePointsThatTheyCount) {
  const Drive drive = make_drive("hdl64", 1, false, 0.0, false);
  const SimulatedSweep sweep = sweep_of(drive, 1);
  int large = 0;
  for (const SimulatedBox& box : sweep.boxes) {
    EXPECT_NE(box.kind, "Pedestrian") << "nothing moves in a static drive";
    const Pose frame = upright(box.middle, std::cos(box.yaw), std::sin(box.yaw));
    int inside = 0;
    for (std::size_t i = 0; i < sweep.cloud.size(); ++i) {
      const Vec3 q = frame.invert(point(sweep.cloud, i));
      // The box's yaw is all its attitude: on a slope a corner sticks out by a few centimetres, and
      // a near car's ends were met some milliseconds before and after its middle.
      inside += std::abs(q.x) < 0.5 * box.length + 0.1 && std::abs(q.y) < 0.5 * box.width + 0.1 &&
                std::abs(q.z) < 0.5 * box.height + 0.2;
    }
    // What the sweep's seam divides was met at its begin and at its end.
    EXPECT_GE(inside, box.points * 9 / 10);
    if (box.points < 200) continue;
    ++large;
    EXPECT_LT(inside, 2 * box.points) << "the ground beside it, but not much more";
  }
  EXPECT_GT(large, 2);
}

TEST(Simulate, MovingThingsHaveBoxesToo) {
  const SimulatedSweep sweep = sweep_of(noisy_hdl64(), 1);
  int cars = 0;
  int people = 0;
  for (const SimulatedBox& box : sweep.boxes) {
    EXPECT_GE(box.points, 1);
    (box.kind == "Pedestrian" ? people : cars) += 1;
  }
  EXPECT_GT(people, 0);
  EXPECT_GT(cars, 5);
}

TEST(Simulate, RefusesWhatItCannotDo) {
  SimulateOptions options;
  options.sensor = "hdl65";
  EXPECT_EQ(Drive::create(options).error().code, ErrorCode::invalid_argument);
  EXPECT_NE(Drive::create(options).error().message.find("hdl65"), std::string::npos);
  options = {};
  options.sweeps = 0;
  EXPECT_EQ(Drive::create(options).error().code, ErrorCode::invalid_argument);
  options = {};
  options.blocks = 2;
  EXPECT_EQ(Drive::create(options).error().code, ErrorCode::invalid_argument);
}

TEST(Random, NormalHasMeanZeroAndVarianceOne) {
  Random random(3);
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < 100'000; ++i) {
    const double value = random.normal();
    ASSERT_LE(std::abs(value), 6.0);
    sum += value;
    squares += value * value;
  }
  EXPECT_NEAR(sum / 1e5, 0.0, 0.015);
  EXPECT_NEAR(squares / 1e5, 1.0, 0.02);
}

}  // namespace
}  // namespace sweepcast::lab
