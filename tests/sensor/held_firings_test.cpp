// A driver that interpolates azimuths, but not those of a packet's last firing.
#include "sensor/held_firings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "lab/real_sweeps.hpp"
#include "sensor/beam_grid.hpp"
#include "sensor/spinning_lidar.hpp"
#include "sweepcast/cloud_file.hpp"

namespace sweepcast {
namespace {

constexpr int kTurn = 36'000;
constexpr std::size_t kPacket = 3;  // firings; the last one is held

/// 16 beams, the lower eight of which fire late, so that their azimuths are interpolated.
SensorModel interpolated_model() {
  SensorModel model = test::made_up_model();
  model.ticks_per_turn = kTurn;
  for (std::size_t k = 0; k < model.beams.size(); ++k) {
    Beam& beam = model.beams[k];
    beam.interpolated = k < 8 ? 0 : 11 + static_cast<int>(k % 4);
    beam.lag = 3 * static_cast<int>(k) + beam.interpolated;
    beam.azimuth_offset = 0;
  }
  return model;
}

/// Firings 20 ticks apart, now and then 19.
const std::vector<int>& firing_ticks() {
  static const std::vector<int> ticks = [] {
    std::mt19937 random(1);
    std::vector<int> made;
    for (int tick = 0; tick < kTurn; tick += test::random_bits(random) % 12 == 0 ? 19 : 20) {
      made.push_back(tick);
    }
    return made;
  }();
  return ticks;
}

bool is_held(std::size_t firing) {
  return firing % kPacket == kPacket - 1;
}

/// A sweep in a wavy room; every fifth point is missing.
PointCloud sweep_of(const SensorModel& model) {
  PointCloud cloud;
  for (std::size_t j = 0; j < firing_ticks().size(); ++j) {
    for (std::size_t k = 0; k < model.beams.size(); ++k) {
      if ((j * 7 + k * 3) % 5 == 0) continue;
      const int tick = firing_ticks()[j] - (is_held(j) ? model.beams[k].interpolated : 0);
      const double rho = 8.0 + 5.0 * std::sin(0.003 * static_cast<double>(j * (3 + k % 4)));
      test::push(cloud, test::point_of(model, k, tick, rho));
    }
  }
  return cloud;
}

TEST(HeldFirings, HaveAColumnEachAndEveryPointItsPlace) {
  const SensorModel model = interpolated_model();
  const PointCloud cloud = sweep_of(model);
  BeamImage image;
  BeamProjector(model).project(cloud, {}, image);
  EXPECT_TRUE(image.extras.empty());
  ASSERT_EQ(image.firing_tick, firing_ticks());
  ASSERT_EQ(image.held.size(), static_cast<std::size_t>(image.cols));
  for (std::size_t j = 0; j < image.held.size(); ++j) {
    ASSERT_EQ(image.held[j] != 0, is_held(j)) << "firing " << j;
  }
  PointCloud back;
  BeamUnprojector(model).unproject(image, back);
  std::size_t at = 0;
  for (const std::uint32_t i : image.point) {
    if (i == kNoPoint) continue;
    ASSERT_LT(test::distance(cloud, i, back, at), 0.001);
    ++at;
  }
  EXPECT_EQ(at, cloud.size());
}

/// Per beam, the ticks of its points in a sweep of the model.
std::vector<std::vector<std::int32_t>> ticks_of(const SensorModel& model, bool holds) {
  std::vector<std::vector<std::int32_t>> ticks(model.beams.size());
  for (std::size_t k = 0; k < ticks.size(); ++k) {
    const Beam& beam = model.beams[k];
    for (std::size_t j = 0; j < firing_ticks().size(); ++j) {
      const int lag = beam.lag - (holds && is_held(j) ? beam.interpolated : 0);
      ticks[k].push_back((firing_ticks()[j] + lag) % kTurn);
    }
  }
  return ticks;
}

TEST(HeldFirings, TellWhatPartOfLagsIsInterpolated) {
  const SensorModel model = interpolated_model();
  std::vector<std::int32_t> lags;
  for (const Beam& beam : model.beams) lags.push_back(beam.lag);
  lags[9] += 20;  // as where firings are nearly at equal distances
  lags[12] -= 20;
  const auto interpolated = fit_interpolation(ticks_of(model, true), lags, kTurn);
  for (std::size_t k = 0; k < model.beams.size(); ++k) {
    EXPECT_EQ(interpolated[k], model.beams[k].interpolated) << "beam " << k;
    EXPECT_EQ(lags[k], model.beams[k].lag) << "beam " << k;
  }
}

TEST(HeldFirings, ThereAreNoneWhereLagsAlwaysHold) {
  const SensorModel model = interpolated_model();
  std::vector<std::int32_t> lags;
  for (const Beam& beam : model.beams) lags.push_back(beam.lag);
  const std::vector<std::int32_t> before = lags;
  const auto interpolated = fit_interpolation(ticks_of(model, false), lags, kTurn);
  EXPECT_EQ(std::count(interpolated.begin(), interpolated.end(), 0), 16);
  EXPECT_EQ(lags, before);
}

/// Ticks of beams all of whose lags are interpolated, by `share` of the distance to the next
/// firing; every twelfth firing is held.
std::vector<std::vector<std::int32_t>> scattered_ticks(std::span<const double> share, bool holds) {
  std::mt19937 random(3);
  std::vector<std::vector<std::int32_t>> ticks(share.size());
  int tick = 0;
  for (std::size_t j = 0; tick < kTurn - 100; ++j) {
    constexpr std::array kOff{-2, -1, 0, 0, 0, 0, 1, 2};
    const int next = tick + 20 + kOff[test::random_bits(random) % kOff.size()];
    for (std::size_t k = 0; k < share.size(); ++k) {
      if (test::random_bits(random) % 10 == 0) continue;
      const bool held = holds && j % 12 == 11;
      const auto turned = held ? 0 : std::lround(share[k] * (next - tick));
      ticks[k].push_back((tick + 7 * static_cast<int>(k % 5) + static_cast<int>(turned)) % kTurn);
    }
    tick = next;
  }
  return ticks;
}

TEST(ScatteredHolds, TellWhatPartOfEachBeamsLagIsInterpolated) {
  std::vector<double> share;
  std::vector<std::int32_t> truth, lags;
  for (int k = 0; k < 32; ++k) {
    share.push_back(0.03 * k);
    truth.push_back(static_cast<std::int32_t>(std::lround(20 * share.back())));
    lags.push_back(7 * (k % 5) + truth.back());
  }
  const std::vector<std::int32_t> lags_before = lags;
  lags[5] += 20;  // as where firings are nearly at equal distances
  lags[21] -= 20;
  const auto interpolated = fit_scattered_holds(scattered_ticks(share, true), lags, kTurn);
  // The ticks of held firings may all be moved alike, and so may the lags by whole steps. Where
  // points turn by nearly a whole step, those of the firing before lie beside, and tell another
  // tick.
  int exact = 0;
  for (std::size_t k = 0; k < share.size(); ++k) {
    const std::int32_t off = interpolated[k] - interpolated[0] - truth[k];
    EXPECT_LE(std::abs(off), 2) << "beam " << k;
    EXPECT_EQ(lags[k] - lags[0], lags_before[k] - lags_before[0]) << "beam " << k;
    exact += off == 0 ? 1 : 0;
  }
  EXPECT_GE(exact, 30);
}

TEST(ScatteredHolds, ThereAreNoneWhereNoFiringIsHeld) {
  std::vector<double> share;
  std::vector<std::int32_t> lags;
  for (int k = 0; k < 32; ++k) {
    share.push_back(0.03 * k);
    lags.push_back(7 * (k % 5) + static_cast<std::int32_t>(std::lround(20 * share.back())));
  }
  const std::vector<std::int32_t> before = lags;
  const auto interpolated = fit_scattered_holds(scattered_ticks(share, false), lags, kTurn);
  EXPECT_EQ(std::count(interpolated.begin(), interpolated.end(), 0), 32);
  EXPECT_EQ(lags, before);
}

/// A real sweep, and the model that is estimated from it.
class HeldFiringsOfARealSweep : public ::testing::Test {
 protected:
  void read(const char* name) {
    const auto paths = lab::nebula_sweeps({name});
    if (paths.empty()) GTEST_SKIP() << "needs SWEEPCAST_DATA";
    ASSERT_TRUE(read_cloud(paths.front(), cloud_));
    const CloudView view(cloud_);
    const auto estimate = estimate_sensor_model(std::span(&view, 1));
    ASSERT_TRUE(estimate) << estimate.error().message;
    model_ = estimate->model;
  }

  PointCloud cloud_;
  SensorModel model_;
};

TEST_F(HeldFiringsOfARealSweep, AreATwelfthOfAllWhereTheyAreScattered) {
  ASSERT_NO_FATAL_FAILURE(read("vlp32.pcd"));
  if (IsSkipped()) return;
  EXPECT_LE(model_.jitter, 4);  // 20 to a model that does not know of held firings
  BeamImage image;
  BeamGridOptions options;
  options.max_error_m = 0.01;
  BeamProjector(model_).project(cloud_, options, image);
  EXPECT_LT(image.cols, 1'000);  // of 907 firings
  EXPECT_LT(image.extras.size(), 100U);
  EXPECT_NEAR(static_cast<double>(std::count(image.held.begin(), image.held.end(), 1)), 76.0, 4.0);
}

TEST_F(HeldFiringsOfARealSweep, AreAThirdOfAll) {
  ASSERT_NO_FATAL_FAILURE(read("vls128.pcd"));
  if (IsSkipped()) return;
  BeamImage image;
  BeamProjector(model_).project(cloud_, {}, image);
  EXPECT_TRUE(image.extras.empty());
  EXPECT_LT(image.cols, 2'000);  // 4,385 to a model that does not know of held firings
  EXPECT_NEAR(static_cast<double>(std::count(image.held.begin(), image.held.end(), 1)), 601.0,
              60.0);
}

TEST(HeldFirings, APointThatFitsNeitherLosesItsPlace) {
  // Beam 1 lags by 5 ticks where turning. Firing 100 is held; beam 1's point at 100 + 5 is neither
  // a held firing's nor, as firing 100 is held, a turning one's.
  const std::vector<std::int32_t> interpolated{0, 5, 5, 5};
  std::vector<FiringPlace> places{{100, 0}, {95, 1}, {95, 2}, {95, 3}, {100, 1}};
  HeldFirings finder;
  const auto held = finder.find(places, interpolated, 1000);
  EXPECT_EQ(held[100], 1);
  EXPECT_EQ(std::count(held.begin(), held.end(), 1), 1);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(places[i].tick, 100);
  EXPECT_EQ(places[4].tick, -1);
}

}  // namespace
}  // namespace sweepcast
