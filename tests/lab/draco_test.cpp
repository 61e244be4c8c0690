#include "lab/peers/draco.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lab/distortion.hpp"
#include "lab/real_sweeps.hpp"

namespace sweepcast::lab {
namespace {

PointCloud corkscrew(std::size_t count) {
  PointCloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    const auto t = static_cast<float>(i) * 0.01F;
    cloud.x.push_back(20.0F * std::cos(t));
    cloud.y.push_back(20.0F * std::sin(t));
    cloud.z.push_back(0.1F * t);
  }
  return cloud;
}

TEST(Draco, GivesBackEveryPointWithinItsStep) {
  const auto peer = make_draco_peer({.quantisation_bits = 12, .compression_level = 7});
  ASSERT_TRUE(peer) << peer.error().message;
  EXPECT_EQ((*peer)->codec(), "draco-kd");
  EXPECT_EQ((*peer)->setting(), "qp12 cl7");
  const PointCloud cloud = corkscrew(2000);
  const auto bytes = (*peer)->encode(cloud);
  ASSERT_TRUE(bytes) << bytes.error().message;
  EXPECT_LT(bytes->size(), cloud.size() * 12 / 2);
  PointCloud decoded;
  ASSERT_TRUE((*peer)->decode(*bytes, decoded));
  ASSERT_EQ(decoded.size(), cloud.size());
  const double step = 40.0 / 4095;  // the largest extent, over 2^12 - 1 steps
  EXPECT_LE(compare(cloud, decoded).max_o2d, std::sqrt(3.0) * step / 2 * 1.001);
}

TEST(Draco, LeavesOutWhatIsNotFinite) {
  const auto peer = make_draco_peer({});
  ASSERT_TRUE(peer) << peer.error().message;
  PointCloud cloud = corkscrew(100);
  cloud.x[3] = std::numeric_limits<float>::quiet_NaN();
  cloud.z[50] = std::numeric_limits<float>::infinity();
  PointCloud decoded;
  const auto bytes = (*peer)->encode(cloud);
  ASSERT_TRUE(bytes) << bytes.error().message;
  ASSERT_TRUE((*peer)->decode(*bytes, decoded));
  EXPECT_EQ(decoded.size(), 98U);
}

TEST(Draco, TakesAnEmptyCloudAndRefusesDamage) {
  const auto peer = make_draco_peer({});
  ASSERT_TRUE(peer) << peer.error().message;
  PointCloud decoded = corkscrew(3);
  const auto bytes = (*peer)->encode(PointCloud{});
  ASSERT_TRUE(bytes) << bytes.error().message;
  ASSERT_TRUE((*peer)->decode(*bytes, decoded));
  EXPECT_TRUE(decoded.empty());
  const std::array<std::byte, 8> noise{};
  EXPECT_FALSE((*peer)->decode(noise, decoded));
}

TEST(Draco, RefusesSettingsOutOfRange) {
  EXPECT_FALSE(make_draco_peer({.quantisation_bits = 0}));
  EXPECT_FALSE(make_draco_peer({.quantisation_bits = 31}));
  EXPECT_FALSE(make_draco_peer({.quantisation_bits = 11, .compression_level = 11}));
}

TEST(Draco, ExplicitStepsAreThoseThatItTakes) {
  const PointCloud cloud = corkscrew(2000);
  for (const double step : {0.0231, 0.5}) {
    const auto peer = make_draco_peer({.step_m = step});
    ASSERT_TRUE(peer) << peer.error().message;
    const auto bytes = (*peer)->encode(cloud);
    ASSERT_TRUE(bytes) << bytes.error().message;
    PointCloud decoded;
    ASSERT_TRUE((*peer)->decode(*bytes, decoded));
    ASSERT_EQ(decoded.size(), cloud.size());
    const double worst = draco_worst_error(cloud, step);
    EXPECT_GT(worst, 0.6 * step);
    EXPECT_LE(worst, std::sqrt(3.0) / 2 * step + 1e-5);
    // The points keep far enough from each other that at the fine step each is nearest to its own.
    if (step < 0.1) {
      EXPECT_NEAR(compare(cloud, decoded).max_o2d, worst, 1e-6);
    }
  }
  EXPECT_EQ((*make_draco_peer({.step_m = 0.0231}))->setting(), "step 0.0231 m");
  EXPECT_FALSE(make_draco_peer({.step_m = -1.0}));
}

TEST(Draco, TheCoarsestStepStaysWithinTheBoundAndNoCoarserOneDoes) {
  const std::vector<PointCloud> clouds{corkscrew(300), corkscrew(2000), PointCloud{}};
  const auto step = coarsest_draco_step(clouds, 0.02);
  ASSERT_TRUE(step) << step.error().message;
  EXPECT_GT(*step, 0.99 * 0.02 * 2 / std::sqrt(3.0));
  for (const PointCloud& cloud : clouds) EXPECT_LE(draco_worst_error(cloud, *step), 0.02);
  for (int more = 1; more < 40; ++more) {
    const double coarser = *step + 2e-5 * more;
    EXPECT_GT(
        std::max(draco_worst_error(clouds[0], coarser), draco_worst_error(clouds[1], coarser)),
        0.02);
  }
  EXPECT_FALSE(coarsest_draco_step(clouds, 0.0));
}

/// Known by another route: the same coder, run by other software.
TEST(Draco, OnRealSweepsIsTheKnownOne) {
  const auto sweeps = real_sweeps("kitti_hdl64");
  if (sweeps.empty()) GTEST_SKIP() << "set SWEEPCAST_DATA to a folder with kitti_hdl64";
  const auto peer = make_draco_peer({.quantisation_bits = 11, .compression_level = 7});
  ASSERT_TRUE(peer) << peer.error().message;
  DistortionMean means;
  double bytes = 0;
  for (const auto& path : sweeps) {
    const PointCloud cloud = read_kitti(path);
    const auto frame = (*peer)->encode(cloud);
    ASSERT_TRUE(frame) << frame.error().message;
    PointCloud decoded;
    ASSERT_TRUE((*peer)->decode(*frame, decoded));
    bytes += static_cast<double>(frame->size()) / static_cast<double>(sweeps.size());
    means.add(compare(cloud, decoded));
  }
  const Distortion mean = means.mean();
  EXPECT_NEAR(bytes, 58190, 100);
  EXPECT_NEAR(mean.mean_o2d, 0.0351, 0.0001);
  EXPECT_NEAR(mean.rms_d2o, 0.0314, 0.0001);
  EXPECT_NEAR(mean.d1_psnr, 69.03, 0.01);
  EXPECT_NEAR(mean.d2_psnr, 73.80, 0.02);
  EXPECT_NEAR(mean.f_score[0], 12.13, 0.1);
  EXPECT_NEAR(mean.f_score[1], 96.05, 0.1);
}

}  // namespace
}  // namespace sweepcast::lab
