#include "lab/odometry/trajectory.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace sweepcast::lab {
namespace {

namespace fs = std::filesystem;

class TrajectoryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("sweepcast-trajectory-" +
               std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const std::string& text) {
    const fs::path file = folder_ / "poses.txt";
    std::ofstream(file) << text;
    return file;
  }

  fs::path folder_;
};

// Straight ahead, `step` metres a sweep, turning by `turn` radians in each.
std::vector<RigidTransform> path(int sweeps, double step, double turn) {
  std::vector<RigidTransform> poses{RigidTransform::Identity()};
  Twist twist = Twist::Zero();
  twist[0] = step;
  twist[5] = turn;
  for (int i = 1; i < sweeps; ++i) poses.push_back(poses.back() * exp(twist));
  return poses;
}

TEST_F(TrajectoryTest, APathThatIsOnePercentTooLongIsOnePercentOff) {
  const auto error = trajectory_error(path(501, 1.0, 0.0), path(501, 1.01, 0.0));
  ASSERT_TRUE(error.has_value());
  // The benchmark's stretches end at the first sweep beyond their length: here one metre later.
  EXPECT_NEAR(error->translation_percent, 1.0, 0.01);
  EXPECT_NEAR(error->rotation_deg_per_m, 0.0, 1e-12);
  EXPECT_NEAR(error->length_m, 500.0, 1e-9);
  // Starts 0, 10, ... with as many stretches as the rest of the path has hundreds of metres, less
  // those that would end beyond the last sweep.
  EXPECT_EQ(error->stretches, 40 + 30 + 20 + 10);
  EXPECT_NEAR(error->step_translation_m, 0.01, 1e-9);
}

TEST_F(TrajectoryTest, ATurnTooMuchIsCountedByTheMetre) {
  const double turn = 0.001;
  const auto error = trajectory_error(path(201, 1.0, 0.0), path(201, 1.0, turn));
  ASSERT_TRUE(error.has_value());
  const double degrees = turn * 180.0 / std::numbers::pi;
  EXPECT_NEAR(error->step_rotation_deg, degrees, 1e-9);
  EXPECT_NEAR(error->rotation_deg_per_m, degrees * 101.0 / 100.0, 1e-6);
}

TEST_F(TrajectoryTest, WhereBothBeginDoesNotMatter) {
  auto moved = path(150, 1.0, 0.01);
  Twist twist;
  twist << 10, 20, 30, 0.1, 0.2, 0.3;
  for (auto& pose : moved) pose = exp(twist) * pose;
  const auto error = trajectory_error(path(150, 1.0, 0.01), moved);
  ASSERT_TRUE(error.has_value());
  EXPECT_GT(error->stretches, 0);
  EXPECT_NEAR(error->translation_percent, 0.0, 1e-9);
}

TEST_F(TrajectoryTest, AShortPathHasNoStretches) {
  const auto error = trajectory_error(path(50, 1.0, 0.0), path(50, 1.0, 0.0));
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(error->stretches, 0);
}

TEST_F(TrajectoryTest, OtherNumbersOfPosesCannotBeCompared) {
  EXPECT_FALSE(trajectory_error(path(3, 1.0, 0.0), path(4, 1.0, 0.0)).has_value());
  EXPECT_FALSE(trajectory_error(path(1, 1.0, 0.0), path(1, 1.0, 0.0)).has_value());
}

TEST_F(TrajectoryTest, FilesGiveBackWhatWasWritten) {
  const auto poses = path(30, 1.0, 0.05);
  const fs::path file = folder_ / "poses.txt";
  ASSERT_TRUE(write_poses(file, poses).has_value());
  const auto read = read_poses(file);
  ASSERT_TRUE(read.has_value()) << read.error().message;
  ASSERT_EQ(read->size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT(((*read)[i].matrix() - poses[i].matrix()).norm(), 1e-7);
  }
}

TEST_F(TrajectoryTest, LinesThatAreNoPoseAreNamed) {
  const std::string good = "1 0 0 5 0 1 0 6 0 0 1 7\n";
  const auto read = read_poses(write(good + "\r\n" + good));
  ASSERT_TRUE(read.has_value());
  ASSERT_EQ(read->size(), 2U);
  EXPECT_EQ(read->back().translation(), Eigen::Vector3d(5, 6, 7));
  for (const std::string bad :
       {"1 0 0 5 0 1 0 6 0 0 1", "1 0 0 5 0 1 0 6 0 0 1 7 8", "1 0 0 nan 0 1 0 6 0 0 1 7",
        "2 0 0 5 0 2 0 6 0 0 2 7", "-1 0 0 5 0 -1 0 6 0 0 -1 7", "one 0 0 5 0 1 0 6 0 0 1 7"}) {
    const auto refused = read_poses(write(good + bad + "\n"));
    ASSERT_FALSE(refused.has_value()) << bad;
    EXPECT_NE(refused.error().message.find("line 2"), std::string::npos) << bad;
  }
  EXPECT_EQ(read_poses(folder_ / "none.txt").error().code, ErrorCode::not_found);
}

}  // namespace
}  // namespace sweepcast::lab
