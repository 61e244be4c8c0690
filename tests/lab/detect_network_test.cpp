// PointPillars with the weights that the project ships, and its training.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "lab/detect/average_precision.hpp"
#include "lab/detect/detector.hpp"
#include "lab/detect/train_pillars.hpp"
#include "lab/drives.hpp"

namespace sweepcast::lab {
namespace {

namespace fs = std::filesystem;

std::vector<Box> truth_of(const SimulatedSweep& sweep) {
  std::vector<Box> boxes;
  for (const SimulatedBox& box : sweep.boxes) {
    Box same;
    same.label = box.kind;
    same.centre = {box.middle.x, box.middle.y, box.middle.z};
    same.length = box.length;
    same.width = box.width;
    same.height = box.height;
    same.yaw = box.yaw;
    same.points = box.points;
    boxes.push_back(same);
  }
  return boxes;
}

class PillarNetworks : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / (std::string("sweepcast_pillars_") + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  static std::string bytes_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  fs::path folder_;
};

TEST_F(PillarNetworks, ShippedWeightsFindCars) {
  std::vector<std::vector<Box>> truth, found;
  const auto detector = make_pillar_detector(SWEEPCAST_WEIGHTS);
  ASSERT_TRUE(detector) << detector.error().message;
  for (const int index : {0, 2}) {
    const SimulatedSweep sweep = sweep_of(noisy_hdl64(), index);
    truth.push_back(truth_of(sweep));
    auto boxes = (*detector)->detect(sweep.cloud);
    ASSERT_TRUE(boxes) << boxes.error().message;
    for (std::size_t i = 1; i < boxes->size(); ++i) {
      EXPECT_LE((*boxes)[i].score, (*boxes)[i - 1].score);
    }
    found.push_back(std::move(*boxes));
  }
  EXPECT_GT(detection_score(truth, found).bev_ap50, 85.0);
  EXPECT_GT(detection_score(truth, found).bev_ap70, 65.0);
  const auto nothing = (*detector)->detect({});
  ASSERT_TRUE(nothing);
  EXPECT_TRUE(nothing->empty());
}

TEST_F(PillarNetworks, TrainingIsRepeatableAndItsWeightsReadBack) {
  LabelledSweep sweep;
  const SimulatedSweep simulated = sweep_of(noisy_hdl64(), 1);
  sweep.x = simulated.cloud.x;
  sweep.y = simulated.cloud.y;
  sweep.z = simulated.cloud.z;
  sweep.boxes = truth_of(simulated);
  TrainOptions options;
  options.steps = 2;
  options.batch = 1;
  double first = 0.0, last = 0.0;
  for (const char* name : {"one", "two"}) {
    const Status trained =
        train_pillars(std::span(&sweep, 1), options, folder_ / name,
                      [&](int step, double loss) { (step == 1 ? first : last) = loss; });
    ASSERT_TRUE(trained) << trained.error().message;
  }
  EXPECT_TRUE(std::isfinite(first) && std::isfinite(last));
  EXPECT_GT(first, 0.0);
  const std::string weights = bytes_of(folder_ / "one");
  EXPECT_EQ(weights, bytes_of(folder_ / "two"));
  EXPECT_LT(weights.size(), 2U << 20U);
  EXPECT_EQ(weights.size(), bytes_of(SWEEPCAST_WEIGHTS).size());
  const auto detector = make_pillar_detector(folder_ / "one");
  ASSERT_TRUE(detector) << detector.error().message;
  EXPECT_TRUE((*detector)->detect(simulated.cloud));
}

TEST_F(PillarNetworks, DamagedWeightsAreRefused) {
  const std::string good = bytes_of(SWEEPCAST_WEIGHTS);
  const auto refusal = [&](const std::string& bytes) {
    std::ofstream(folder_ / "w", std::ios::binary) << bytes;
    const auto detector = make_pillar_detector(folder_ / "w");
    return detector ? std::string("none") : std::string(name(detector.error().code));
  };
  EXPECT_EQ(refusal(good), "none");
  EXPECT_EQ(refusal(""), "corrupt");
  EXPECT_EQ(refusal("no weights at all, and long enough for a head"), "corrupt");
  EXPECT_EQ(refusal(good.substr(0, good.size() - 4)), "truncated");
  std::string changed = good;
  changed[good.size() / 2] = static_cast<char>(changed[good.size() / 2] ^ 1);
  EXPECT_EQ(refusal(changed), "corrupt");
  changed = good;
  changed[16] = static_cast<char>(changed[16] ^ 1);  // the number of weights
  EXPECT_EQ(refusal(changed), "unsupported");
  EXPECT_EQ(make_pillar_detector(folder_ / "absent").error().code, ErrorCode::not_found);
}

TEST_F(PillarNetworks, TrainingRefusesWhatItCannotDo) {
  EXPECT_EQ(train_pillars({}, {}, folder_ / "w").error().code, ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace sweepcast::lab
