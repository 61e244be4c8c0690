// Drives in files.
#include "lab/simulate/export.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "lab/drives.hpp"
#include "sweepcast/cloud_file.hpp"

namespace sweepcast::lab {
namespace {

namespace fs = std::filesystem;

class Export : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / (std::string("sweepcast_simulate_") + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string text_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  fs::path folder_;
};

TEST_F(Export, FilesDoNotDependOnThreads) {
  ExportOptions options;
  options.threads = 1;
  ASSERT_TRUE(write_drive(exact_vlp16(), folder_ / "one", options));
  options.threads = 3;
  ASSERT_TRUE(write_drive(exact_vlp16(), folder_ / "three", options));
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "one")) {
    if (!entry.is_regular_file()) continue;
    ++files;
    const fs::path other = folder_ / "three" / fs::relative(entry.path(), folder_ / "one");
    EXPECT_EQ(text_of(entry.path()), text_of(other)) << other;
  }
  EXPECT_EQ(files, 3 + 3 + 3);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 2) << "nothing temporary stays";
}

TEST_F(Export, SweepsAndMeshReadBack) {
  ASSERT_TRUE(write_drive(exact_vlp16(), folder_ / "drive", {}));
  PointCloud read;
  ASSERT_TRUE(read_cloud(folder_ / "drive" / "sweeps" / "000001.pcd", read));
  const PointCloud made = sweep_of(exact_vlp16(), 1).cloud;
  EXPECT_EQ(read.x, made.x);
  EXPECT_EQ(read.ring, made.ring);
  EXPECT_EQ(read.intensity, made.intensity);
  const std::string mesh = text_of(folder_ / "drive" / "mesh.ply");
  const auto number_after = [&](const std::string& key) {
    return std::stoul(mesh.substr(mesh.find(key) + key.size()));
  };
  const std::string end = "end_header\n";
  EXPECT_EQ(mesh.size() - mesh.find(end) - end.size(),
            12 * number_after("element vertex ") + 13 * number_after("element face "));
  EXPECT_EQ(text_of(folder_ / "drive" / "poses.txt").substr(0, 24), "1.000000000 0.000000000 ");
}

TEST_F(Export, KeepsWhatIsThereUnlessForced) {
  std::ofstream(folder_ / "notes.txt") << "mine";
  ExportOptions options;
  options.kitti = true;
  const auto refused = write_drive(exact_vlp16(), folder_, options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_argument);
  EXPECT_NE(refused.error().message.find("--force"), std::string::npos);
  options.force = true;
  ASSERT_TRUE(write_drive(exact_vlp16(), folder_, options));
  EXPECT_EQ(text_of(folder_ / "notes.txt"), "mine");
  EXPECT_EQ(fs::file_size(folder_ / "sweeps" / "000000.bin") % 16, 0U);
  EXPECT_FALSE(write_drive(exact_vlp16(), folder_ / "notes.txt", options));
  EXPECT_FALSE(write_drive(exact_vlp16(), folder_ / "notes.txt" / "below", options));
}

}  // namespace
}  // namespace sweepcast::lab
