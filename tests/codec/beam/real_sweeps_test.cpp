// Codec beam on real sweeps: every point within the bound, and the ratio on KITTI's five.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>

#include "codec/beam/sensor.hpp"
#include "lab/real_sweeps.hpp"
#include "sweepcast/cloud_file.hpp"

namespace sweepcast {
namespace {

/// One sweep of each kind of sensor that is there; the PandaSet and odometry ones are deskewed.
std::vector<std::filesystem::path> one_of_each() {
  auto paths =
      lab::first_sweeps({"kitti_hdl64", "kitti_0048", "kitti_odom00", "pandaset_pandar64"});
  const char* data = std::getenv("SWEEPCAST_DATA");
  if (data == nullptr || !std::filesystem::is_directory(std::filesystem::path(data) / "nebula")) {
    return paths;
  }
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(data) / "nebula")) {
    if (entry.path().extension() == ".pcd") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

constexpr double kMaxError = 0.02;

TEST(BeamRealSweeps, EveryPointOfEverySensorIsWithinTheBound) {
  const auto paths = one_of_each();
  if (paths.empty()) GTEST_SKIP() << "set SWEEPCAST_DATA to a folder with real sweeps";
  for (const auto& path : paths) {
    PointCloud cloud;
    ASSERT_TRUE(read_cloud(path, cloud).has_value()) << path;
    SCOPED_TRACE(path.string());
    Encoder encoder = test::encoder_of(test::beam_options(kMaxError));
    const test::Bytes frame = test::encode(encoder, cloud);
    test::expect_kept(cloud, test::decode(frame), encoder.last_counts(), kMaxError);
  }
}

struct Row {
  double max_error_m, ratio;
};

TEST(BeamRealSweeps, RatioOnKitti) {
  const auto paths = lab::real_sweeps("kitti_hdl64");
  if (paths.empty()) GTEST_SKIP() << "set SWEEPCAST_DATA to a folder with kitti_hdl64";
  ASSERT_EQ(paths.size(), 5U);
  constexpr std::array<Row, 6> kRows{
      {{0.01, 37}, {0.02, 46}, {0.05, 64}, {0.1, 87}, {0.2, 120}, {0.4, 160}}};
  for (const Row& row : kRows) {
    EncoderOptions options = test::beam_options(row.max_error_m);
    options.beam.fields = Fields::xyz;
    Encoder encoder = test::encoder_of(options);
    Decoder decoder;
    double ratios = 0;
    double raw = 0;
    double coded = 0;
    for (const auto& path : paths) {
      const PointCloud cloud = lab::read_kitti(path);
      const test::Bytes frame = test::encode(encoder, cloud);
      PointCloud decoded;
      ASSERT_TRUE(decoder.decode(frame, decoded).has_value());
      EXPECT_EQ(decoded.size(), test::codable(cloud).size());
      const auto size = 16.0 * static_cast<double>(cloud.size());
      ratios += size / static_cast<double>(frame.size()) / 5;
      raw += size;
      coded += static_cast<double>(frame.size());
    }
    SCOPED_TRACE("max error " + std::to_string(row.max_error_m));
    EXPECT_GE(ratios, row.ratio);
    EXPECT_GE(raw / coded, row.ratio);
    RecordProperty("ratio", std::to_string(raw / coded));
  }
}

}  // namespace
}  // namespace sweepcast
