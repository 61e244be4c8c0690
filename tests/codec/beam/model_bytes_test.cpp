// Sensor models and firings as bytes and back, and what becomes of damaged ones.
#include "codec/beam/model_bytes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/random.hpp"

namespace sweepcast::beam {
namespace {

using test::random_bits;
using test::uniform_int;

Mount random_mount(std::mt19937& random) {
  Mount mount;
  for (auto& v : mount.translation)
    v = uniform_int(random, -100 * kLengthUnits, 100 * kLengthUnits);
  for (auto& v : mount.rotation) v = uniform_int(random, -90 * kAngleUnits, 90 * kAngleUnits);
  return mount;
}

SensorModel random_model(std::mt19937& random) {
  SensorModel model;
  model.mount = random_mount(random);
  model.ticks_per_turn = uniform_int(random, 1, kMaxTicks);
  model.direction = uniform_int(random, -1, 1);
  model.jitter = uniform_int(random, 0, std::min(3, model.ticks_per_turn));
  const int beams = random_bits(random) % 8 == 0 ? kMaxBeams : uniform_int(random, 1, 128);
  const bool alike = random_bits(random) % 2 == 0;
  for (int k = 0; k < beams; ++k) {
    Beam beam;
    beam.tan_elevation = uniform_int(random, -100, 99) * kTangentUnits + uniform_int(random, 0, 99);
    beam.height = uniform_int(random, -10 * kLengthUnits, 10 * kLengthUnits);
    beam.azimuth_offset = uniform_int(random, -360, 359) * kAngleUnits + uniform_int(random, 0, 9);
    beam.lateral_offset = uniform_int(random, -10 * kLengthUnits, 10 * kLengthUnits);
    beam.lag = uniform_int(random, -model.ticks_per_turn, model.ticks_per_turn);
    beam.time_offset = uniform_int(random, -360 * kAngleUnits, 360 * kAngleUnits);
    beam.interpolated =
        alike ? 7 % model.ticks_per_turn : uniform_int(random, -3, 3) % model.ticks_per_turn;
    model.beams.push_back(beam);
  }
  std::sort(model.beams.begin(), model.beams.end(),
            [](const Beam& a, const Beam& b) { return a.tan_elevation > b.tan_elevation; });
  return model;
}

std::vector<std::byte> bytes_of(const SensorModel& model) {
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  write_model(model, out);
  return bytes;
}

TEST(ModelBytes, ModelsComeBack) {
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    const SensorModel model = random_model(random);
    ASSERT_TRUE(check(model).has_value()) << check(model).error().message;
    const std::vector<std::byte> bytes = bytes_of(model);
    ByteReader in(bytes);
    SensorModel back;
    ASSERT_TRUE(read_model(in, back));
    EXPECT_EQ(back, model);
    EXPECT_TRUE(in.at_end());
  }
}

TEST(ModelBytes, MotionsComeBack) {
  std::mt19937 random(6);
  for (int i = 0; i < 100; ++i) {
    Motion motion;
    for (auto& v : motion.translation) v = uniform_int(random, -100'000'000, 100'000'000);
    for (auto& v : motion.rotation) v = uniform_int(random, -90'000'000, 90'000'000);
    motion.zero_tick = uniform_int(random, 0, kMaxTicks);
    motion.mount = random_mount(random);
    motion.nod = uniform_int(random, -kTangentUnits, kTangentUnits);
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    write_motion(motion, out);
    ByteReader in(bytes);
    EXPECT_EQ(read_motion(in), motion);
    EXPECT_TRUE(in.at_end());
  }
}

TEST(ModelBytes, CutModelsAreRefused) {
  std::mt19937 random(2);
  const std::vector<std::byte> bytes = bytes_of(random_model(random));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ByteReader in(std::span<const std::byte>(bytes).first(size));
    SensorModel back;
    EXPECT_FALSE(read_model(in, back)) << size;
  }
}

TEST(ModelBytes, DamagedModelsAreRefusedOrStillWithinTheirBounds) {
  std::mt19937 random(3);
  int refused = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::vector<std::byte> bytes(static_cast<std::size_t>(uniform_int(random, 0, 60)));
    if (i % 2 == 0) {
      for (std::byte& byte : bytes) byte = static_cast<std::byte>(random_bits(random));
    } else {
      bytes = bytes_of(random_model(random));
      for (int n = uniform_int(random, 1, 3); n > 0; --n) {
        bytes[random_bits(random) % bytes.size()] = static_cast<std::byte>(random_bits(random));
      }
    }
    ByteReader in(bytes);
    SensorModel back;
    if (read_model(in, back)) {
      EXPECT_TRUE(check(back).has_value());
    } else {
      ++refused;
    }
  }
  EXPECT_GT(refused, 10'000);
}

TEST(ModelBytes, NumbersBeyondTheirBoundsAreRefused) {
  const SensorModel sound{2000, 1, 0, {{100, 0, 0, 0, 0, 0}, {50, 0, 0, 0, 0, 0}}, {}};
  ASSERT_TRUE(check(sound).has_value());
  const auto is_refused = [&](auto change) {
    SensorModel model = sound;
    change(model);
    const std::vector<std::byte> bytes = bytes_of(model);
    ByteReader in(bytes);
    return !read_model(in, model);
  };
  EXPECT_FALSE(is_refused([](SensorModel&) {}));
  EXPECT_TRUE(is_refused([](SensorModel& m) { m.ticks_per_turn = 0; }));
  EXPECT_TRUE(is_refused([](SensorModel& m) { m.ticks_per_turn = kMaxTicks + 1; }));
  EXPECT_TRUE(is_refused([](SensorModel& m) { m.direction = 2; }));
  EXPECT_TRUE(is_refused([](SensorModel& m) { m.beams.clear(); }));
  EXPECT_TRUE(is_refused([](SensorModel& m) { m.beams.resize(kMaxBeams + 1, m.beams[1]); }));
  EXPECT_TRUE(is_refused([](SensorModel& m) { std::swap(m.beams[0], m.beams[1]); }));
  EXPECT_TRUE(is_refused([](SensorModel& m) { m.beams[0].tan_elevation = 101 * kTangentUnits; }));
  EXPECT_TRUE(is_refused([](SensorModel& m) { m.beams[1].height = 11 * kLengthUnits; }));
  EXPECT_TRUE(is_refused([](SensorModel& m) { m.beams[1].lag = 2001; }));
  EXPECT_TRUE(is_refused([](SensorModel& m) { m.beams[1].interpolated = -2001; }));
  EXPECT_TRUE(is_refused([](SensorModel& m) { m.beams[1].time_offset = 361 * kAngleUnits; }));
  EXPECT_TRUE(is_refused([](SensorModel& m) { m.mount.translation[2] = -101 * kLengthUnits; }));
  EXPECT_TRUE(is_refused([](SensorModel& m) { m.mount.rotation[0] = 91 * kAngleUnits; }));
}

std::vector<std::int32_t> back_of(const std::vector<std::byte>& bytes, std::size_t count,
                                  std::int32_t turn) {
  std::vector<std::int32_t> ticks(count);
  EXPECT_TRUE(FiringCoder().read(bytes, turn, ticks));
  return ticks;
}

TEST(FiringBytes, TicksComeBack) {
  std::mt19937 random(4);
  for (int i = 0; i < 200; ++i) {
    std::vector<std::int32_t> ticks;
    const int widest = std::array{1, 3, 40, 30'000, 900'000}[random_bits(random) % 5];
    for (std::int32_t tick = uniform_int(random, 0, widest);
         tick < kMaxTicks && ticks.size() < 3000; tick += uniform_int(random, 1, widest)) {
      ticks.push_back(tick);
    }
    if (i == 0) ticks.clear();
    std::vector<std::byte> bytes;
    FiringCoder().write(ticks, bytes);
    EXPECT_EQ(back_of(bytes, ticks.size(), kMaxTicks), ticks);
  }
}

TEST(FiringBytes, PeriodicTicksCostLittle) {
  std::vector<std::int32_t> ticks;
  for (std::int32_t tick = 0; tick < 4000; tick += ticks.size() % 6 == 0 ? 3 : 2) {
    ticks.push_back(tick);
  }
  std::vector<std::byte> bytes;
  FiringCoder().write(ticks, bytes);
  EXPECT_LT(bytes.size(), 60U) << ticks.size() << " firings";
  EXPECT_EQ(back_of(bytes, ticks.size(), 4000), ticks);
}

TEST(FiringBytes, WhichFiringsAreHeldCostsLittle) {
  std::vector<std::int32_t> ticks;
  std::vector<std::uint8_t> held;
  for (std::int32_t tick = 0; tick < 36'000; tick += 20) {
    held.push_back(ticks.size() % 12 == 11 ? 1 : 0);
    ticks.push_back(tick);
  }
  std::vector<std::byte> alone, both;
  FiringCoder().write(ticks, alone);
  FiringCoder().write(ticks, both, held);
  EXPECT_LT(both.size(), alone.size() + 40U);
  std::vector<std::int32_t> ticks_back(ticks.size());
  std::vector<std::uint8_t> held_back(ticks.size(), 2);
  EXPECT_TRUE(FiringCoder().read(both, 36'000, ticks_back, held_back));
  EXPECT_EQ(ticks_back, ticks);
  EXPECT_EQ(held_back, held);
}

TEST(FiringBytes, TicksBeyondTheTurnAreRefused) {
  std::vector<std::int32_t> ticks{3, 500, 1999};
  std::vector<std::byte> bytes;
  FiringCoder().write(ticks, bytes);
  EXPECT_TRUE(FiringCoder().read(bytes, 2000, ticks));
  EXPECT_FALSE(FiringCoder().read(bytes, 1999, ticks));
}

TEST(FiringBytes, DamagedBytesAreRefusedOrStillIncrease) {
  std::mt19937 random(5);
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::byte> bytes(static_cast<std::size_t>(uniform_int(random, 0, 200)));
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random_bits(random));
    std::vector<std::int32_t> ticks(static_cast<std::size_t>(uniform_int(random, 0, 300)));
    if (!FiringCoder().read(bytes, 2000, ticks)) continue;
    for (std::size_t k = 0; k < ticks.size(); ++k) {
      EXPECT_TRUE(ticks[k] < 2000 && ticks[k] > (k == 0 ? -1 : ticks[k - 1]));
    }
  }
}

}  // namespace
}  // namespace sweepcast::beam
