#include "lab/bench.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/distortion_report.hpp"
#include "io/support.hpp"
#include "lab/peers/sweepcast_codec.hpp"
#include "lab/plot.hpp"

namespace sweepcast::lab {
namespace {

namespace fs = std::filesystem;

/// A codec with known figures: so many bytes a point, and every point comes back higher by `lift`.
class KnownPeer : public Peer {
 public:
  KnownPeer(std::string setting, std::size_t bytes_per_point, float lift, std::string& calls)
      : Peer("known", std::move(setting)),
        bytes_per_point_(bytes_per_point),
        lift_(lift),
        calls_(calls) {}

  Result<std::span<const std::byte>> encode(const PointCloud& cloud) override {
    calls_ += setting();
    cloud_ = cloud;
    if (bytes_per_point_ == 0) return fail(ErrorCode::limit, "no bytes left");
    bytes_.resize(bytes_per_point_ * cloud.size());
    return std::span<const std::byte>(bytes_);
  }

  Status decode(std::span<const std::byte> /*bytes*/, PointCloud& cloud) override {
    cloud = cloud_;
    for (float& z : cloud.z) z += lift_;
    return {};
  }

 private:
  std::size_t bytes_per_point_;
  float lift_;
  std::string& calls_;
  PointCloud cloud_;
  std::vector<std::byte> bytes_;
};

/// A folder of its own, removed at the end.
class Bench : public testing::Test {
 protected:
  Bench()
      : folder_(fs::temp_directory_path() / ("sweepcast_bench_test_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~Bench() override { fs::remove_all(folder_); }

  /// A level square of side x side points as KITTI .bin.
  fs::path write_square(const std::string& name, int side) {
    fs::path path = folder_ / name;
    std::ofstream file(path, std::ios::binary);
    for (int i = 0; i < side; ++i) {
      for (int j = 0; j < side; ++j) {
        const std::array<float, 4> point{5.0F + static_cast<float>(i), static_cast<float>(j), -1.5F,
                                         0.0F};
        file.write(reinterpret_cast<const char*>(point.data()), sizeof(point));
      }
    }
    return path;
  }

  fs::path folder_;
  std::string calls_;
};

TEST_F(Bench, TakesTheMeanOverSweeps) {
  const std::vector<fs::path> sweeps{write_square("a.bin", 10), write_square("b.bin", 20)};
  Peers peers;
  peers.push_back(std::make_unique<KnownPeer>("fine", 4, 0.0625F, calls_));
  peers.push_back(std::make_unique<KnownPeer>("coarse", 2, 0.25F, calls_));
  std::vector<std::string> names;
  const auto rows =
      bench(sweeps, peers,
            {.runs = 1, .on_sweep = [&](std::string_view name) { names.emplace_back(name); }});
  ASSERT_TRUE(rows) << rows.error().message;
  ASSERT_EQ(rows->size(), 2U);
  const BenchRow& coarse = rows->at(1);
  EXPECT_EQ(coarse.codec, "known");
  EXPECT_EQ(coarse.setting, "coarse");
  EXPECT_DOUBLE_EQ(coarse.ratio, 8.0);
  EXPECT_DOUBLE_EQ(coarse.bytes, 500.0);
  EXPECT_DOUBLE_EQ(coarse.points_in, 250.0);
  EXPECT_DOUBLE_EQ(coarse.points_out, 250.0);
  EXPECT_DOUBLE_EQ(coarse.distortion.max_o2d, 0.25);
  EXPECT_DOUBLE_EQ(rows->at(0).ratio, 4.0);
  EXPECT_DOUBLE_EQ(rows->at(0).distortion.mean_d2o, 0.0625);
  EXPECT_GE(coarse.encode_ms, 0.0);
  EXPECT_EQ(names, (std::vector<std::string>{"a.bin", "b.bin"}));
}

TEST_F(Bench, PeersTakeTurnsInEveryRun) {
  Peers peers;
  peers.push_back(std::make_unique<KnownPeer>("A", 1, 0.0F, calls_));
  peers.push_back(std::make_unique<KnownPeer>("B", 1, 0.0F, calls_));
  const std::vector<fs::path> sweeps{write_square("a.bin", 2)};
  ASSERT_TRUE(bench(sweeps, peers, {.runs = 3, .on_sweep = {}}));
  EXPECT_EQ(calls_, "ABABABAB");  // the first turn warms up
}

TEST_F(Bench, NamesTheFileAndTheCodecThatFailed) {
  Peers peers;
  peers.push_back(std::make_unique<KnownPeer>("empty", 0, 0.0F, calls_));
  const auto failed = bench(std::vector<fs::path>{write_square("a.bin", 2)}, peers, {});
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::limit);
  EXPECT_NE(failed.error().message.find("a.bin: known empty: no bytes left"), std::string::npos);
  const auto missing = bench(std::vector<fs::path>{folder_ / "missing.bin"}, peers, {});
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::not_found);
}

TEST_F(Bench, RefusesToMeasureNothing) {
  EXPECT_FALSE(bench({}, {}, {}));
  EXPECT_FALSE(bench(std::vector<fs::path>{write_square("a.bin", 2)}, {}, {.runs = 0}));
}

TEST_F(Bench, MeasuresOurCodec) {
  EncoderOptions options;
  options.codec = CodecId::rcpcc;
  options.rcpcc.params = kRcpccLevels[0];
  Peers peers;
  auto peer = make_sweepcast_peer(options, "L0");
  ASSERT_TRUE(peer) << peer.error().message;
  peers.push_back(std::move(*peer));
  const auto rows = bench(std::vector<fs::path>{write_square("a.bin", 20)}, peers, {.runs = 1});
  ASSERT_TRUE(rows) << rows.error().message;
  EXPECT_EQ(rows->at(0).codec, "rcpcc");
  EXPECT_GT(rows->at(0).ratio, 1.0);
  EXPECT_GT(rows->at(0).points_out, 300.0);
  EXPECT_LT(rows->at(0).distortion.mean_d2o, 0.2);
}

TEST_F(Bench, CountsFilledPoints) {
  class FillingPeer : public KnownPeer {
   public:
    using KnownPeer::KnownPeer;
    Status decode(std::span<const std::byte> bytes, PointCloud& cloud) override {
      Status decoded = KnownPeer::decode(bytes, cloud);
      cloud.filled.assign(cloud.size(), 0);
      for (std::size_t i = 0; i < cloud.size(); i += 4) cloud.filled[i] = 1;
      return decoded;
    }
  };
  Peers peers;
  peers.push_back(std::make_unique<FillingPeer>("fill", 1, 0.0F, calls_));
  peers.push_back(std::make_unique<KnownPeer>("plain", 1, 0.0F, calls_));
  const auto rows = bench(std::vector<fs::path>{write_square("a.bin", 10)}, peers, {.runs = 1});
  ASSERT_TRUE(rows) << rows.error().message;
  EXPECT_DOUBLE_EQ(rows->at(0).points_filled, 25.0);
  EXPECT_DOUBLE_EQ(rows->at(0).points_out, 100.0);
  EXPECT_DOUBLE_EQ(rows->at(1).points_filled, 0.0);
}

TEST(SweepcastPeer, RefusesOptionsThatTheEncoderRefuses) {
  EncoderOptions options;
  options.codec = CodecId::rcpcc;
  options.rcpcc.params.azimuth_step_deg = -1.0;
  const auto peer = make_sweepcast_peer(options, "wrong");
  ASSERT_FALSE(peer);
  EXPECT_EQ(peer.error().code, ErrorCode::invalid_argument);
}

BenchRow row_of(const std::string& codec, const std::string& setting, double ratio, double d2) {
  BenchRow row;
  row.codec = codec;
  row.setting = setting;
  row.ratio = ratio;
  row.distortion.d2_psnr = d2;
  return row;
}

TEST(Plot, HasACurveForEachCodecOrderedByRatio) {
  const std::vector<BenchRow> rows{row_of("a", "L1", 40, 60.5), row_of("b", "qp8 cl7", 30, 55.25),
                                   row_of("a", "L0", 20, 70)};
  const std::string script = rate_distortion_script(rows, "out.png");
  EXPECT_NE(script.find("$data0 << END\n20 70 \"L0\"\n40 60.5 \"L1\"\nEND\n"), std::string::npos);
  EXPECT_NE(script.find("$data1 << END\n30 55.25 \"qp8\"\nEND\n"), std::string::npos);
  EXPECT_NE(script.find("pngcairo"), std::string::npos);
  EXPECT_NE(rate_distortion_script(rows, "out.svg").find("terminal svg"), std::string::npos);
}

TEST(Plot, LeavesOutWhatHasNoNumberAndQuotesNames) {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<BenchRow> rows{row_of("a \"b\"", "lossless", 2, infinity),
                                   row_of("a \"b\"", "x", 3, 50)};
  const std::string script = rate_distortion_script(rows, "plot.png");
  EXPECT_NE(script.find("$data0 << END\n3 50 \"x\"\nEND\n"), std::string::npos);
  EXPECT_NE(script.find(R"(title "a \"b\"")"), std::string::npos);
}

TEST(Plot, IsThereWholeOrNotAtAll) {
  const test::TemporaryFolder folder;
  const auto path = folder / "it's \"$(plot)\".svg";
  const Status possible = check_plot(path);
  if (!possible) GTEST_SKIP() << possible.error().message;
  EXPECT_TRUE(folder.names().empty());
  EXPECT_FALSE(draw_plot("this is no script", path));
  EXPECT_TRUE(folder.names().empty());
  ASSERT_TRUE(plot_rate_distortion(std::vector{row_of("a", "x", 3, 50)}, path));
  EXPECT_EQ(folder.names().size(), 1U);
  std::string text;
  for (const std::byte byte : test::read_bytes(path)) text += static_cast<char>(byte);
  EXPECT_NE(text.find("<svg"), std::string::npos);
  EXPECT_NE(text.find("</svg>"), std::string::npos);
  const auto missing = check_plot(folder / "no/plot.svg");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("make the folder"), std::string::npos);
}

TEST(Plot, RefusesOtherFormatsAndNoRows) {
  const auto gif = plot_rate_distortion(std::vector{row_of("a", "x", 3, 50)}, "plot.gif");
  ASSERT_FALSE(gif);
  EXPECT_EQ(gif.error().code, ErrorCode::invalid_argument);
  EXPECT_FALSE(plot_rate_distortion({}, "plot.png"));
}

TEST(DistortionReport, HasTheKeysThatOthersRelyOnAndNoNaN) {
  nlohmann::ordered_json report;
  Distortion distortion;
  distortion.points_original = 122598;
  distortion.d1_psnr = std::numeric_limits<double>::infinity();
  distortion.mean_o2d = std::numeric_limits<double>::quiet_NaN();
  distortion.f_score = {1, 2, 3, 4.5};
  app::add_distortion(report, distortion);
  for (const char* key : {"points_original", "points_decoded", "mean_o2d", "rms_o2d", "max_o2d",
                          "mean_d2o", "rms_d2o", "max_d2o", "d1_psnr", "d2_psnr",
                          "mean_azimuth_error_deg", "mean_elevation_error_deg"}) {
    EXPECT_TRUE(report.contains(key)) << key;
  }
  EXPECT_EQ(report["points_original"].dump(), "122598");
  EXPECT_TRUE(report["d1_psnr"].is_null());
  EXPECT_TRUE(report["mean_o2d"].is_null());
  std::set<std::string> keys;
  for (const auto& [key, value] : report["f_score"].items()) keys.insert(key);
  EXPECT_EQ(keys, (std::set<std::string>{"0.02", "0.05", "0.10", "0.20"}));
  EXPECT_EQ(report["f_score"]["0.20"], 4.5);
}

}  // namespace
}  // namespace sweepcast::lab
