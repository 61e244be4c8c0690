#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string>

#include "codec/damage.hpp"
#include "core/points.hpp"
#include "core/random.hpp"
#include "lab/distortion.hpp"
#include "lab/peers/j2k.hpp"
#include "lab/peers/jpegls.hpp"
#include "lab/peers/pcl_octree.hpp"
#include "lab/peers/registry.hpp"
#include "lab/peers/zstd_grid.hpp"
#include "lab/real_sweeps.hpp"

namespace sweepcast::lab {
namespace {

constexpr std::size_t kBeams = 32;
constexpr std::size_t kColumns = 512;

/// A sensor of 32 beams 1.7 m above a floor between walls, every azimuth in the middle of one of
/// 512 columns; a tenth of the points is missing.
PointCloud made_sweep(std::uint32_t seed = 3) {
  std::mt19937 random(seed);
  PointCloud cloud;
  for (std::size_t beam = 0; beam < kBeams; ++beam) {
    const double tangent = 0.05 - 0.4 * static_cast<double>(beam) / kBeams;
    for (std::size_t column = 0; column < kColumns; ++column) {
      const double azimuth =
          ((static_cast<double>(column) + 0.5) / kColumns - 0.5) * 2 * std::numbers::pi;
      const double to_wall = 8.0 / std::max(std::abs(std::sin(azimuth)), 0.2);
      // A slope: beams whose ranges are all alike do not tell their heights.
      const double to_floor =
          tangent < 0 ? -1.7 / tangent * (1 + 0.4 * std::sin(3 * azimuth)) : 1e9;
      const double rho = std::min(to_wall, to_floor) + test::uniform(random, -0.01, 0.01);
      if (test::random_bits(random) % 10 == 0) continue;
      test::add_point(cloud, rho * std::cos(azimuth), rho * std::sin(azimuth), rho * tangent);
      cloud.ring.push_back(static_cast<std::uint16_t>(beam));
    }
  }
  return cloud;
}

std::vector<std::byte> encode(Peer& peer, const PointCloud& cloud) {
  const auto bytes = peer.encode(cloud);
  EXPECT_TRUE(bytes) << peer.codec() << ": " << (bytes ? "" : bytes.error().message);
  return bytes ? std::vector<std::byte>(bytes->begin(), bytes->end()) : std::vector<std::byte>{};
}

PointCloud round_trip(Peer& peer, const PointCloud& cloud) {
  PointCloud decoded = made_sweep(9);  // to be forgotten
  const auto bytes = encode(peer, cloud);
  const Status status = peer.decode(bytes, decoded);
  EXPECT_TRUE(status) << peer.codec() << ": " << (status ? "" : status.error().message);
  return decoded;
}

bool is_finite(const PointCloud& cloud) {
  const auto finite = [](float v) { return std::isfinite(v); };
  return std::all_of(cloud.x.begin(), cloud.x.end(), finite) &&
         std::all_of(cloud.y.begin(), cloud.y.end(), finite) &&
         std::all_of(cloud.z.begin(), cloud.z.end(), finite);
}

/// The peer, or none where this build lacks it.
template <class Options>
std::unique_ptr<Peer> made(Result<std::unique_ptr<Peer>> (*make)(const Options&),
                           const Options& options) {
  auto peer = make(options);
  if (peer) return std::move(*peer);
  EXPECT_EQ(peer.error().code, ErrorCode::unsupported) << peer.error().message;
  return nullptr;
}

TEST(Jpegls, EveryPointStaysWithinItsBound) {
  const PointCloud cloud = made_sweep();
  double last = 0.0;
  for (const int near : {0, 10, 50}) {
    JpeglsOptions options;
    options.form.columns = kColumns;
    options.near = near;
    const auto peer = made(make_jpegls_peer, options);
    if (!peer) GTEST_SKIP() << "built without CharLS";
    EXPECT_EQ(peer->setting(), "beams x 512, near " + std::to_string(near));
    const PointCloud decoded = round_trip(*peer, cloud);
    EXPECT_EQ(decoded.size(), cloud.size());
    const double worst = compare(cloud, decoded).max_o2d;
    EXPECT_LE(worst, 0.002 * near + 0.001 + 0.001);  // rounding, and the rows' own
    EXPECT_GT(worst, last);
    last = worst;
  }
}

TEST(Jpegls, RefusesSettingsOutOfRange) {
  EXPECT_FALSE(make_jpegls_peer({.near = -1}));
  EXPECT_FALSE(make_jpegls_peer({.near = 256}));
  EXPECT_FALSE(make_jpegls_peer({.form = {.columns = 15}}));
  EXPECT_FALSE(make_jpegls_peer({.form = {.beam_aligned = false}}));
}

TEST(J2k, TakesTheBytesOfItsRateAndKeepsEveryMeasuredCell) {
  const PointCloud cloud = made_sweep();
  double last = 0.0;
  for (const double rate : {2.0, 8.0, 32.0}) {
    const auto peer = made(make_j2k_peer, J2kOptions{{.columns = kColumns}, rate});
    if (!peer) GTEST_SKIP() << "built without OpenJPEG";
    const double picture = 2.0 * kBeams * kColumns / rate;
    const auto size = static_cast<double>(encode(*peer, cloud).size());
    EXPECT_GT(size, 0.5 * picture);
    EXPECT_LT(size, picture + kBeams * kColumns / 8.0 + 6 * kBeams + 20);  // mask, rows, head
    const PointCloud decoded = round_trip(*peer, cloud);
    EXPECT_EQ(decoded.size(), cloud.size());
    const double mean = compare(cloud, decoded).mean_o2d;
    EXPECT_GT(mean, last);
    EXPECT_LT(mean, rate < 4.0 ? 0.003 : 1.0);
    last = mean;
  }
}

TEST(J2k, TheNaiveFormKeepsWhatItsRowsCan) {
  const auto peer =
      made(make_j2k_peer, J2kOptions{{.columns = kColumns, .beam_aligned = false}, 2.0});
  if (!peer) GTEST_SKIP() << "built without OpenJPEG";
  EXPECT_EQ(peer->codec(), "j2k-range-naive");
  EXPECT_EQ(peer->setting(), "64 x 512, rate 2");
  const PointCloud cloud = made_sweep();
  const PointCloud decoded = round_trip(*peer, cloud);
  EXPECT_GT(decoded.size(), cloud.size() * 9 / 10);
  const double half_row = (std::atan(0.05) - std::atan(-0.35)) / 64 / 2;
  EXPECT_LT(compare(cloud, decoded).mean_o2d, 40.0 * half_row);
}

TEST(J2k, RefusesSettingsOutOfRange) {
  EXPECT_FALSE(make_j2k_peer({.rate = 0.5}));
  EXPECT_FALSE(make_j2k_peer({.rate = std::nan("")}));
  EXPECT_FALSE(make_j2k_peer({.form = {.columns = 1 << 17}}));
}

TEST(ZstdGrid, PointsAreWithinHalfACubesDiagonal) {
  const PointCloud cloud = made_sweep();
  for (const GridOrder order : {GridOrder::as_given, GridOrder::morton}) {
    for (const double step : {0.001, 0.05, 1.0}) {
      const auto peer = make_zstd_grid_peer({.step_m = step, .order = order});
      ASSERT_TRUE(peer) << peer.error().message;
      const PointCloud decoded = round_trip(**peer, cloud);
      const double most = std::sqrt(3.0) / 2 * step + 1e-5;
      const Distortion distortion = compare(cloud, decoded);
      EXPECT_LE(distortion.max_o2d, most);
      EXPECT_LE(distortion.max_d2o, most);
      if (order == GridOrder::as_given) {
        ASSERT_EQ(decoded.size(), cloud.size());
        for (std::size_t i = 0; i < cloud.size(); ++i) {
          ASSERT_NEAR(decoded.x[i], cloud.x[i], step / 2 + 1e-5);
          ASSERT_NEAR(decoded.z[i], cloud.z[i], step / 2 + 1e-5);
        }
      } else {
        EXPECT_EQ(decoded.size() < cloud.size() / 2, step == 1.0);
      }
    }
  }
}

TEST(ZstdGrid, RefusesSettingsOutOfRange) {
  EXPECT_FALSE(make_zstd_grid_peer({.step_m = 0.0}));
  EXPECT_FALSE(make_zstd_grid_peer({.step_m = std::nan("")}));
  EXPECT_FALSE(make_zstd_grid_peer({.step_m = 101.0}));
  EXPECT_FALSE(make_zstd_grid_peer({.level = 23}));
}

TEST(PclOctree, PointsAreWithinHalfACubesDiagonal) {
  const PointCloud cloud = made_sweep();
  for (const double step : {0.01, 0.2}) {
    const auto peer = made(make_pcl_octree_peer, PclOctreeOptions{step});
    if (!peer) GTEST_SKIP() << "built without PCL";
    const PointCloud decoded = round_trip(*peer, cloud);
    EXPECT_LE(compare(cloud, decoded).max_o2d, std::sqrt(3.0) / 2 * step + 1e-4);
    EXPECT_LE(decoded.size(), cloud.size());
  }
  EXPECT_FALSE(make_pcl_octree_peer({.step_m = 0.0}));
  EXPECT_FALSE(make_pcl_octree_peer({.step_m = std::nan("")}));
}

/// What holds for every codec that this build has.
class EveryPeer : public testing::Test {
 protected:
  void SetUp() override {
    auto choice = make_peers(std::vector<std::string>{"all"});
    ASSERT_TRUE(choice) << choice.error().message;
    for (auto& peer : choice->peers) {
      by_codec_.insert_or_assign(peer->codec(), std::move(peer));  // one setting will do
    }
    ASSERT_GE(by_codec_.size(), 2U);
  }

  template <class Do>
  void each(Do act) {
    for (auto& [codec, peer] : by_codec_) act(*peer);
  }

  std::map<std::string, std::unique_ptr<Peer>> by_codec_;
};

TEST_F(EveryPeer, EncodesTheSameTwiceAndForgetsTheLastSweep) {
  const PointCloud cloud = made_sweep();
  each([&](Peer& peer) {
    const auto first = encode(peer, cloud);
    EXPECT_GT(first.size(), 0U) << peer.codec();
    (void)encode(peer, made_sweep(7));
    EXPECT_EQ(encode(peer, cloud), first) << peer.codec();
  });
}

TEST_F(EveryPeer, TakesSweepsWithoutAnyPoint) {
  PointCloud nothing;
  test::add_point(nothing, std::nan(""), 1.0, 2.0);
  each([&](Peer& peer) {
    EXPECT_TRUE(round_trip(peer, PointCloud{}).empty()) << peer.codec();
    EXPECT_TRUE(round_trip(peer, nothing).empty()) << peer.codec();
  });
}

TEST_F(EveryPeer, LeavesOutWhatItCannotRepresent) {
  PointCloud cloud = made_sweep();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  cloud.x[3] = std::nanf("");
  cloud.y[70] = kInfinity;
  cloud.z[500] = -kInfinity;
  each([&](Peer& peer) {
    const PointCloud decoded = round_trip(peer, cloud);
    EXPECT_TRUE(is_finite(decoded)) << peer.codec();
    EXPECT_GT(decoded.size(), 0U) << peer.codec();
    if (peer.codec() != "j2k-range-naive") {  // which invents points around gaps
      EXPECT_LE(decoded.size(), cloud.size() - 3) << peer.codec();
    }
  });
}

TEST_F(EveryPeer, TakesFewAndOddPoints) {
  PointCloud one;
  test::add_point(one, 5.0, 4.0, 1.0);
  PointCloud odd;
  for (const double x : {0.0, 1e-30, 1e4, -1e4}) test::add_point(odd, x, 0.0, 0.0);
  test::add_point(odd, 0.0, 0.0, 7.0);
  each([&](Peer& peer) {
    const PointCloud decoded = round_trip(peer, one);
    ASSERT_LE(decoded.size(), 1U) << peer.codec();
    if (peer.codec() != "j2k-range-naive") {
      ASSERT_EQ(decoded.size(), 1U) << peer.codec();
    }
    if (!decoded.empty()) {
      EXPECT_LT(compare(one, decoded).max_o2d, 1.5) << peer.codec();
    }
    EXPECT_TRUE(is_finite(round_trip(peer, odd))) << peer.codec();
  });
}

TEST_F(EveryPeer, SurvivesDamage) {
  std::mt19937 random(11);
  const PointCloud cloud = made_sweep();
  std::size_t refused = 0;
  each([&](Peer& peer) {
    const auto whole = encode(peer, cloud);
    const std::vector<std::vector<std::byte>> others{encode(peer, made_sweep(7))};
    for (int i = 0; i < 30; ++i) {
      auto bytes = whole;
      test::mutate(random, others, bytes);
      PointCloud decoded;
      if (!peer.decode(bytes, decoded)) {
        ++refused;
        EXPECT_TRUE(decoded.empty()) << peer.codec();
      }
      EXPECT_TRUE(is_finite(decoded)) << peer.codec();
    }
    PointCloud decoded;
    for (std::size_t size = 1; size < whole.size(); size += whole.size() / 20 + 1) {
      (void)peer.decode(std::span(whole).first(size), decoded);
      EXPECT_TRUE(is_finite(decoded)) << peer.codec() << " " << size;
    }
  });
  EXPECT_GT(refused, 0U);
}

TEST(Registry, NamesAreCheckedAndLaddersComeInTheirOrder) {
  const auto unknown = make_peers(std::vector<std::string>{"zstd", "mp3"});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::invalid_argument);
  EXPECT_NE(unknown.error().message.find("mp3"), std::string::npos);
  EXPECT_NE(unknown.error().message.find("draco"), std::string::npos);
  const auto chosen = make_peers(std::vector<std::string>{"zstd-delta", "zstd"});
  ASSERT_TRUE(chosen) << chosen.error().message;
  ASSERT_GE(chosen->peers.size(), 10U);
  EXPECT_EQ(chosen->peers.front()->codec(), "zstd-morton");
  EXPECT_EQ(chosen->peers.back()->codec(), "zstd-delta");
  EXPECT_TRUE(make_peers({})->peers.empty());
  const auto all = make_peers(std::vector<std::string>{"all"});
  ASSERT_TRUE(all);
  std::size_t there = 0;
  for (const PeerKind& kind : peer_kinds()) {
    const auto alone = make_peers(std::vector<std::string>{std::string(kind.name)});
    if (alone) {
      ++there;
      EXPECT_GE(alone->peers.size(), 5U) << kind.name;
      EXPECT_TRUE(alone->left_out.empty());
    }
  }
  EXPECT_EQ(there + all->left_out.size(), peer_kinds().size());
}

struct Known {
  const char* codec;
  const char* setting;
  double ratio, d1_psnr, f_5cm;
};

/// Known by another route: the same codecs in other hands on the same sweeps.
TEST(Peers, OnRealSweepsAreTheKnownOnes) {
  const auto sweeps = real_sweeps("kitti_hdl64");
  if (sweeps.empty()) GTEST_SKIP() << "set SWEEPCAST_DATA to a folder with kitti_hdl64";
  const std::vector<Known> known{{"j2k-range", "beams x 2048, rate 4", 27.82, 70.82, 98.75},
                                 {"j2k-range", "beams x 1024, rate 20", 254.5, 57.65, 41.75},
                                 {"zstd-delta", "step 0.02 m", 17.40, 80.26, 100.0},
                                 {"pcl-octree", "step 0.1 m", 62.80, 66.33, 57.66}};
  const auto choice = make_peers(std::vector<std::string>{"all"});
  ASSERT_TRUE(choice) << choice.error().message;
  for (const Known& figures : known) {
    for (const auto& peer : choice->peers) {
      if (peer->codec() != figures.codec || peer->setting() != figures.setting) continue;
      double bytes = 0;
      double points = 0;
      DistortionMean means;
      for (const auto& path : sweeps) {
        const PointCloud cloud = read_kitti(path);
        bytes += static_cast<double>(encode(*peer, cloud).size());
        points += static_cast<double>(cloud.size());
        means.add(compare(cloud, round_trip(*peer, cloud)));
      }
      EXPECT_NEAR(16.0 * points / bytes, figures.ratio, 0.03 * figures.ratio) << figures.codec;
      EXPECT_NEAR(means.mean().d1_psnr, figures.d1_psnr, 0.1) << figures.codec;
      EXPECT_NEAR(means.mean().f_score[1], figures.f_5cm, 0.5) << figures.codec;
    }
  }
}

}  // namespace
}  // namespace sweepcast::lab
