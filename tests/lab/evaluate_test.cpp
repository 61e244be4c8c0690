// What is measured, and what is not measured again; with codecs and tasks whose figures are known.
#include "lab/evaluate/evaluate.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "lab/evaluate/tasks.hpp"
#include "lab/evaluate_fixture.hpp"

namespace sweepcast::lab {
namespace {

namespace fs = std::filesystem;

/// So many bytes a point; points come back higher by `lift`. Counts sweeps.
class KnownPeer : public Peer {
 public:
  KnownPeer(std::string setting, std::size_t bytes_a_point, float lift, std::atomic<int>& coded)
      : Peer("known", std::move(setting)),
        bytes_a_point_(bytes_a_point),
        lift_(lift),
        coded_(coded) {}

  Result<std::span<const std::byte>> encode(const PointCloud& cloud) override {
    if (bytes_a_point_ == 0) return fail(ErrorCode::limit, "no bytes left");
    ++coded_;
    cloud_ = cloud;
    bytes_.resize(bytes_a_point_ * cloud.size());
    return std::span<const std::byte>(bytes_);
  }

  Status decode(std::span<const std::byte> /*bytes*/, PointCloud& cloud) override {
    cloud = cloud_;
    for (float& z : cloud.z) z += lift_;
    return {};
  }

 private:
  std::size_t bytes_a_point_;
  float lift_;
  std::atomic<int>& coded_;
  PointCloud cloud_;
  std::vector<std::byte> bytes_;
};

/// The mean lift of the sweeps that it takes, and how many these are.
class LiftTask : public Task {
 public:
  explicit LiftTask(std::size_t every) : Task("lift", "every " + std::to_string(every), every) {}

  Result<std::unique_ptr<TaskRun>> begin() const override {
    class Run : public TaskRun {
     public:
      Status add(const SweepPair& sweep) override {
        lift_ += double{sweep.decoded.z[0]} - double{sweep.original.z[0]};
        ++count_;
        return {};
      }
      Result<Figures> finish() override {
        if (count_ == 0) return fail(ErrorCode::invalid_argument, "no sweeps");
        return Figures{{"lift", lift_ / count_},
                       {"sweeps", count_},
                       {"none", std::numeric_limits<double>::quiet_NaN()}};
      }

     private:
      double lift_ = 0.0, count_ = 0.0;
    };
    return std::make_unique<Run>();
  }
};

class Evaluate : public EvaluateTest {
 protected:
  /// Runs codecs of these bytes a point, the finer the less they lift, on a drive of 5 sweeps.
  Evaluation run(const std::vector<std::size_t>& bytes, std::size_t every = 2, bool fresh = false) {
    if (drive_.sweeps.empty()) drive_ = *open_drive(folder_, write_squares(5, 8));
    Peers peers;
    for (const std::size_t size : bytes) {
      const float lift = size > 0 ? 1.0F / static_cast<float>(size) : 0.0F;
      peers.push_back(
          std::make_unique<KnownPeer>(std::to_string(size) + " bytes", size, lift, coded_));
    }
    Tasks tasks;
    tasks.push_back(std::make_unique<LiftTask>(every));
    coded_ = 0;
    const auto cache = ResultCache::open(folder_ / "cache");
    EXPECT_TRUE(cache);
    EvaluateOptions options;
    options.version = version_;
    options.threads = 2;
    options.fresh = fresh;
    auto result = evaluate(drive_, peers, tasks, *cache, options);
    EXPECT_TRUE(result) << result.error().message;
    return std::move(*result);
  }

  std::vector<fs::path> kept_files() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder_ / "cache")) {
      files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
  }

  DriveFiles drive_;
  std::string version_ = "1";
  std::atomic<int> coded_{0};
};

TEST_F(Evaluate, GivesRatiosAndFiguresOfTheSweepsThatATaskTakes) {
  const Evaluation result = run({4, 2});
  ASSERT_EQ(result.rows.size(), 2U);
  EXPECT_DOUBLE_EQ(result.rows[0].coding.ratio, 4.0);
  EXPECT_DOUBLE_EQ(result.rows[1].coding.ratio, 8.0);
  EXPECT_DOUBLE_EQ(result.rows[1].coding.bytes, 128.0);
  EXPECT_EQ(result.rows[0].setting, "4 bytes");
  EXPECT_DOUBLE_EQ(result.rows[0].figure("lift"), 0.25);
  EXPECT_DOUBLE_EQ(result.rows[1].figure("lift"), 0.5);
  EXPECT_DOUBLE_EQ(result.rows[0].figure("sweeps"), 3.0);  // of 5: the first, third and fifth
  EXPECT_TRUE(std::isnan(result.rows[0].figure("none")));
  EXPECT_TRUE(std::isnan(result.rows[0].figure("never heard of")));
  EXPECT_EQ(coded_, 10);
}

TEST_F(Evaluate, MeasuresNothingTwice) {
  const Evaluation first = run({4, 2});
  EXPECT_EQ(first.measured, 4U);
  EXPECT_EQ(first.kept, 0U);
  const Evaluation second = run({4, 2});
  EXPECT_EQ(coded_, 0);
  EXPECT_EQ(second.measured, 0U);
  EXPECT_EQ(second.kept, 4U);
  ASSERT_EQ(second.rows.size(), 2U);
  EXPECT_DOUBLE_EQ(second.rows[1].figure("lift"), 0.5);
  EXPECT_TRUE(std::isnan(second.rows[0].figure("none")));
  EXPECT_DOUBLE_EQ(second.rows[1].coding.encode_ms, first.rows[1].coding.encode_ms);
  EXPECT_EQ(second.rows[0].coding.picture, first.rows[0].coding.picture);
  run({4, 2}, 2, true);
  EXPECT_EQ(coded_, 10) << "a fresh run takes nothing from before";
}

TEST_F(Evaluate, GoesOnWhereItStopped) {
  run({4, 2});
  const Evaluation more = run({4, 1, 2});
  EXPECT_EQ(coded_, 5) << "the new setting alone";
  EXPECT_EQ(more.kept, 4U);
  ASSERT_EQ(more.rows.size(), 3U);
  EXPECT_DOUBLE_EQ(more.rows[1].coding.ratio, 16.0);
}

TEST_F(Evaluate, MeasuresAgainWhatHasChanged) {
  run({4});
  const Evaluation other_task = run({4}, 1);
  EXPECT_EQ(other_task.measured, 1U) << "the task's options, not the coding";
  EXPECT_DOUBLE_EQ(other_task.rows[0].figure("sweeps"), 5.0);
  version_ = "2";
  EXPECT_EQ(run({4}).measured, 2U);
  const std::string changed(16 * 64, '\0');
  write("000003.bin", changed);
  drive_ = *open_drive(folder_, drive_.sweeps);
  EXPECT_EQ(run({4}).measured, 2U) << "a sweep's bytes";
}

TEST_F(Evaluate, RecognisesDamagedResults) {
  run({4, 2, 1});
  const std::vector<fs::path> files = kept_files();
  ASSERT_EQ(files.size(), 6U);
  std::ofstream(files[0], std::ios::binary | std::ios::trunc) << "";
  fs::resize_file(files[1], fs::file_size(files[1]) / 2);
  {
    std::fstream file(files[2], std::ios::binary | std::ios::in | std::ios::out);
    file.seekg(-20, std::ios::end);
    const int byte = file.get();
    file.seekp(-20, std::ios::end);
    file.put(static_cast<char>(byte ^ 1));
  }
  const Evaluation again = run({4, 2, 1});
  EXPECT_EQ(again.damaged, 3U);
  EXPECT_EQ(again.measured, 3U);
  EXPECT_EQ(again.kept, 3U);
  EXPECT_DOUBLE_EQ(again.rows[1].figure("lift"), 0.5);
  EXPECT_DOUBLE_EQ(again.rows[2].coding.ratio, 16.0);
  EXPECT_EQ(run({4, 2, 1}).kept, 6U) << "the damaged ones were replaced";
}

TEST_F(Evaluate, TellsWhatFailedAndGoesOn) {
  const Evaluation result = run({4, 0});
  ASSERT_EQ(result.rows.size(), 1U);
  ASSERT_EQ(result.failures.size(), 1U);
  EXPECT_EQ(result.failures[0].code, ErrorCode::limit);
  EXPECT_NE(result.failures[0].message.find("known 0 bytes"), std::string::npos);
  EXPECT_NE(result.failures[0].message.find("000000.bin"), std::string::npos);
}

TEST_F(EvaluateTest, ADriveWithoutTruthLeavesItsTasksOut) {
  const auto drive = open_drive(folder_, write_squares(3, 4));
  ASSERT_TRUE(drive);
  const std::vector<std::string> names{"mesh", "odometry", "distortion", "detection"};
  const auto choice = make_tasks(names, *drive, {});
  ASSERT_TRUE(choice) << choice.error().message;
  ASSERT_EQ(choice->tasks.size(), 1U);
  EXPECT_EQ(choice->tasks[0]->name(), "distortion");
  ASSERT_EQ(choice->left_out.size(), 3U);
  EXPECT_EQ(choice->left_out[0].rfind("odometry: ", 0), 0U);
  EXPECT_NE(choice->left_out[0].find("poses.txt"), std::string::npos);
  EXPECT_EQ(choice->left_out[1].rfind("mesh: ", 0), 0U);
  EXPECT_EQ(choice->left_out[2].rfind("detection: ", 0), 0U);
  const std::vector<std::string> unknown{"mesh", "painting"};
  EXPECT_EQ(make_tasks(unknown, *drive, {}).error().code, ErrorCode::invalid_argument);
}

TEST_F(EvaluateTest, ADriveWithBadPosesIsRefused) {
  const auto sweeps = write_squares(3, 4);
  write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const auto few = open_drive(folder_, sweeps);
  ASSERT_FALSE(few);
  EXPECT_EQ(few.error().code, ErrorCode::invalid_argument);
  EXPECT_NE(few.error().message.find("1 poses for 3 sweeps"), std::string::npos);
  write("poses.txt", "1 0 0\n");
  EXPECT_EQ(open_drive(folder_, sweeps).error().code, ErrorCode::corrupt);
}

}  // namespace
}  // namespace sweepcast::lab
