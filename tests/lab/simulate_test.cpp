#include "lab/simulate/simulate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "lab/simulate/export.hpp"
#include "lab/simulate/random.hpp"
#include "lab/simulate/road.hpp"
#include "sweepcast/cloud_file.hpp"

namespace sweepcast::lab {
namespace {

namespace fs = std::filesystem;

Drive make(const std::string& sensor, std::uint64_t seed = 1, bool moving = true,
           double noise = 1.0, bool dropouts = true) {
  SimulateOptions options;
  options.sensor = sensor;
  options.sweeps = 3;
  options.seed = seed;
  options.moving = moving;
  options.noise = noise;
  options.dropouts = dropouts;
  auto drive = Drive::create(options);
  EXPECT_TRUE(drive) << drive.error().message;
  return std::move(*drive);
}

const Drive& noisy_hdl64() {
  static const Drive drive = make("hdl64");
  return drive;
}

const Drive& exact_vlp16() {
  static const Drive drive = make("vlp16", 1, false, 0.0, false);
  return drive;
}

SimulatedSweep sweep_of(const Drive& drive, int index) {
  auto sweep = drive.sweep(index);
  EXPECT_TRUE(sweep) << sweep.error().message;
  return std::move(*sweep);
}

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

Vec3 point(const PointCloud& cloud, std::size_t i) {
  return {static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]),
          static_cast<double>(cloud.z[i])};
}

std::int64_t begin_ns(const Drive& drive, int sweep) {
  return drive.sensor().time_ns(drive.sensor().first_firing(sweep));
}

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

TEST(Simulate, GoldenBytes) {
  // Set down on x86-64 with g++ 12; any machine and compiler must give the same.
  EXPECT_EQ(fingerprint(sweep_of(noisy_hdl64(), 0).cloud), 0x7EACF331E39EF050ULL);
  EXPECT_EQ(fingerprint(sweep_of(noisy_hdl64(), 2).cloud), 0x4B5322D275EAA3D3ULL);
  EXPECT_EQ(fingerprint(sweep_of(exact_vlp16(), 1).cloud), 0x3E37E37B94200DC5ULL);
  EXPECT_EQ(fingerprint(sweep_of(make("os1-128", 5), 1).cloud), 0xFE13A348AF243156ULL);
}

TEST(Simulate, SweepsDoNotDependOnOrderThreadsOrInstance) {
  const Drive again = make("hdl64");
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
  EXPECT_NE(fingerprint(sweep_of(make("hdl64", 2), 0).cloud), hashes[0]);
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
  const Drive noisy = make("vlp16", 1, false, 1.0, false);
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
  const Drive drive = make(GetParam());
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
  const Drive drive = make(GetParam());
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
  const Drive drive = make("hdl64", 1, false, 0.0, false);
  const SimulatedSweep sweep = sweep_of(drive, 1);
  const Pose last = drive.sweep_pose(1);
  std::vector<Vec3> deskewed;
  for (std::size_t i = 0; i < sweep.cloud.size(); ++i) {
    const Pose fired = drive.sensor_pose(begin_ns(drive, 1) + sweep.cloud.time_ns[i]);
    deskewed.push_back(last.invert(fired.apply(point(sweep.cloud, i))));
  }
  int large = 0;
  for (const Box& box : sweep.boxes) {
    EXPECT_NE(box.kind, "Pedestrian") << "nothing moves in a static drive";
    const Pose frame = upright(box.middle, std::cos(box.yaw), std::sin(box.yaw));
    int inside = 0;
    for (Vec3 p : deskewed) {
      const Vec3 q = frame.invert(p);
      // The box's yaw is all its attitude: on a slope a corner sticks out by a few centimetres.
      inside += std::abs(q.x) < 0.5 * box.length + 0.1 && std::abs(q.y) < 0.5 * box.width + 0.1 &&
                std::abs(q.z) < 0.5 * box.height + 0.2;
    }
    EXPECT_GE(inside, box.points);
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
  for (const Box& box : sweep.boxes) {
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

class Export : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / (std::string("sweepcast_simulate_") + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string text_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  fs::path folder_;
};

TEST_F(Export, FilesDoNotDependOnThreads) {
  ExportOptions options;
  options.threads = 1;
  ASSERT_TRUE(write_drive(exact_vlp16(), folder_ / "one", options));
  options.threads = 3;
  ASSERT_TRUE(write_drive(exact_vlp16(), folder_ / "three", options));
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "one")) {
    if (!entry.is_regular_file()) continue;
    ++files;
    const fs::path other = folder_ / "three" / fs::relative(entry.path(), folder_ / "one");
    EXPECT_EQ(text_of(entry.path()), text_of(other)) << other;
  }
  EXPECT_EQ(files, 3 + 3 + 3);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 2) << "nothing temporary stays";
}

TEST_F(Export, SweepsAndMeshReadBack) {
  ASSERT_TRUE(write_drive(exact_vlp16(), folder_ / "drive", {}));
  PointCloud read;
  ASSERT_TRUE(read_cloud(folder_ / "drive" / "sweeps" / "000001.pcd", read));
  const PointCloud made = sweep_of(exact_vlp16(), 1).cloud;
  EXPECT_EQ(read.x, made.x);
  EXPECT_EQ(read.ring, made.ring);
  EXPECT_EQ(read.intensity, made.intensity);
  const std::string mesh = text_of(folder_ / "drive" / "mesh.ply");
  const auto number_after = [&](const std::string& key) {
    return std::stoul(mesh.substr(mesh.find(key) + key.size()));
  };
  const std::string end = "end_header\n";
  EXPECT_EQ(mesh.size() - mesh.find(end) - end.size(),
            12 * number_after("element vertex ") + 13 * number_after("element face "));
  EXPECT_EQ(text_of(folder_ / "drive" / "poses.txt").substr(0, 24), "1.000000000 0.000000000 ");
}

TEST_F(Export, KeepsWhatIsThereUnlessForced) {
  std::ofstream(folder_ / "notes.txt") << "mine";
  ExportOptions options;
  options.kitti = true;
  const auto refused = write_drive(exact_vlp16(), folder_, options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_argument);
  EXPECT_NE(refused.error().message.find("--force"), std::string::npos);
  options.force = true;
  ASSERT_TRUE(write_drive(exact_vlp16(), folder_, options));
  EXPECT_EQ(text_of(folder_ / "notes.txt"), "mine");
  EXPECT_EQ(fs::file_size(folder_ / "sweeps" / "000000.bin") % 16, 0U);
  EXPECT_FALSE(write_drive(exact_vlp16(), folder_ / "notes.txt", options));
  EXPECT_FALSE(write_drive(exact_vlp16(), folder_ / "notes.txt" / "below", options));
}

}  // namespace
}  // namespace sweepcast::lab
