// The evaluation of a small simulated drive by the real codecs and tasks.
#include <algorithm>
#include <cmath>

#include "lab/evaluate/aimed_beam.hpp"
#include "lab/evaluate/evaluate.hpp"
#include "lab/evaluate/tasks.hpp"
#include "lab/evaluate_fixture.hpp"
#include "lab/simulate/export.hpp"
#include "sweepcast/cloud_file.hpp"

namespace sweepcast::lab {
namespace {

constexpr int kSweeps = 4;

class EvaluateDrive : public EvaluateTest {
 protected:
  void SetUp() override {
    SimulateOptions options;
    options.sensor = "vlp16";
    options.sweeps = kSweeps;
    const auto drive = Drive::create(options);
    ASSERT_TRUE(drive) << drive.error().message;
    ASSERT_TRUE(write_drive(*drive, folder_ / "drive", {}));
    std::vector<std::filesystem::path> sweeps;
    for (int i = 0; i < kSweeps; ++i) {
      sweeps.push_back(folder_ / "drive" / "sweeps" / ("00000" + std::to_string(i) + ".pcd"));
    }
    auto opened = open_drive(folder_ / "drive", sweeps);
    ASSERT_TRUE(opened) << opened.error().message;
    files_ = std::move(*opened);
  }

  Evaluation run(const std::vector<std::string>& tasks, const SettingOptions& options) const {
    auto choice = make_tasks(tasks, files_, {.full = true});
    EXPECT_TRUE(choice && choice->left_out.empty());
    auto settings = make_settings(options, files_);
    EXPECT_TRUE(settings);
    const auto cache = ResultCache::open(folder_ / "cache");
    EXPECT_TRUE(cache);
    auto result = evaluate(files_, settings->peers, choice->tasks, *cache, {});
    EXPECT_TRUE(result) << result.error().message;
    return std::move(*result);
  }

  DriveFiles files_;
};

TEST_F(EvaluateDrive, BeamComesOutAtItsRatio) {
  PointCloud first;
  ASSERT_TRUE(read_cloud(files_.sweeps[0], first));
  for (const double ratio : {30.0, 60.0}) {
    auto peer = make_aimed_beam(ratio, first, files_.sweeps.size());
    ASSERT_TRUE(peer) << peer.error().message;
    EXPECT_EQ((*peer)->codec(), "beam");
    double points = 0.0, bytes = 0.0;
    PointCloud cloud, decoded;
    for (const auto& sweep : files_.sweeps) {
      ASSERT_TRUE(read_cloud(sweep, cloud));
      const auto frame = (*peer)->encode(cloud);
      ASSERT_TRUE(frame) << frame.error().message;
      points += static_cast<double>(cloud.size());
      bytes += static_cast<double>(frame->size());
      EXPECT_TRUE((*peer)->decode(*frame, decoded));
      EXPECT_GT(decoded.size(), cloud.size() / 4);
    }
    EXPECT_GE(16.0 * points / bytes, ratio);
    EXPECT_LE(16.0 * points / bytes, 1.03 * ratio);
  }
  EXPECT_EQ(make_aimed_beam(1e6, first, 4).error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(make_aimed_beam(0.5, first, 4).error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(make_aimed_beam(30, first, 0).error().code, ErrorCode::invalid_argument);
}

TEST_F(EvaluateDrive, FiguresFallAsRatiosRise) {
  SettingOptions options;
  options.codecs = {"beam"};
  options.ratios = {20, 40, 80};
  options.peers = {"zstd"};
  options.settings_each = 3;
  const Evaluation result = run({"distortion"}, options);
  const EvaluationRow& original = result.rows.at(0);
  EXPECT_EQ(original.codec, "original");
  EXPECT_DOUBLE_EQ(original.coding.ratio, 1.0);
  EXPECT_DOUBLE_EQ(original.coding.encode_ms, 0.0);
  EXPECT_DOUBLE_EQ(original.figure("f_score.0.02"), 100.0);

  std::vector<const EvaluationRow*> beam, zstd;
  for (const EvaluationRow& row : result.rows) {
    if (row.codec == "beam") beam.push_back(&row);
    if (row.codec == "zstd-morton") zstd.push_back(&row);
  }
  ASSERT_EQ(zstd.size(), 3U) << "the ladder's ends and its middle";
  EXPECT_EQ(zstd.front()->setting, "step 0.01 m");
  EXPECT_EQ(zstd.back()->setting, "step 0.4 m");
  EXPECT_TRUE(zstd.front()->coding.parts.empty());
  ASSERT_EQ(beam.size(), 4U) << "the bound, and the ratios aimed at";
  EXPECT_NEAR(beam[2]->coding.ratio, 40.0, 2.0);
  for (const auto& curve : {beam, zstd}) {
    for (std::size_t i = 1; i < curve.size(); ++i) {
      EXPECT_GT(curve[i]->coding.ratio, curve[i - 1]->coding.ratio);
      EXPECT_LT(curve[i]->figure("d2_psnr"), curve[i - 1]->figure("d2_psnr"));
      EXPECT_LE(curve[i]->figure("f_score.0.05"), curve[i - 1]->figure("f_score.0.05"));
    }
  }
  double sum = 0.0;
  for (const auto& [part, bytes] : beam[0]->coding.parts) sum += bytes;
  EXPECT_NEAR(sum, beam[0]->coding.bytes, 1e-6) << "parts make up the frame";
  EXPECT_TRUE(beam[0]->coding.parts.contains("layer 1"));
  EXPECT_FALSE(beam[0]->coding.picture.empty());
}

TEST_F(EvaluateDrive, TasksTellFineFromCoarse) {
  SettingOptions options;
  options.codecs = {};
  options.peers = {"zstd"};
  options.settings_each = 2;
  const Evaluation result = run({"odometry", "mesh"}, options);
  ASSERT_EQ(result.rows.size(), 3U);
  const EvaluationRow &original = result.rows[0], &fine = result.rows[1], &coarse = result.rows[2];
  EXPECT_DOUBLE_EQ(original.figure("mesh_f10"), 100.0) << "the same mesh";
  EXPECT_LT(original.figure("mesh_f10_truth"), 100.0);
  EXPECT_GT(original.figure("mesh_f10_truth"), 50.0);
  EXPECT_GT(fine.figure("mesh_f10"), 95.0) << "cubes of 1 cm";
  EXPECT_LT(coarse.figure("mesh_f10"), 60.0) << "cubes of 40 cm";
  EXPECT_LT(coarse.figure("mesh_f10_truth"), fine.figure("mesh_f10_truth"));
  EXPECT_TRUE(std::isnan(original.figure("translation_error_percent"))) << "4 m are no 100 m";
  EXPECT_LT(original.figure("step_translation_m"), 1.0) << "a metre is driven from one to the next";
  EXPECT_NEAR(fine.figure("step_translation_m"), original.figure("step_translation_m"), 0.2);
}

}  // namespace
}  // namespace sweepcast::lab
