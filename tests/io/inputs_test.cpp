// The sweeps that a command line names.
#include "common/inputs.hpp"

#include <algorithm>

#include "io/support.hpp"

namespace sweepcast::app {
namespace {

using test::expect_error;
using test::status_of;
using test::TemporaryFolder;
using test::write_text;

Result<std::vector<std::filesystem::path>> collect(const TemporaryFolder& folder,
                                                   std::vector<std::string> inputs) {
  for (std::string& input : inputs) input = (folder / input).string();
  return collect_clouds(inputs);
}

/// Names of the clouds, below the folder; or the error.
std::vector<std::string> collected(const TemporaryFolder& folder,
                                   const std::vector<std::string>& inputs) {
  const auto clouds = collect(folder, inputs);
  if (!clouds) return {clouds.error().message};
  std::vector<std::string> names(clouds->size());
  std::transform(clouds->begin(), clouds->end(), names.begin(), [&](const auto& cloud) {
    return cloud.lexically_relative(folder.path()).generic_string();
  });
  return names;
}

Status failure(const TemporaryFolder& folder, const std::vector<std::string>& inputs) {
  return status_of(collect(folder, inputs));
}

using Names = std::vector<std::string>;

TEST(Inputs, FolderStandsForItsCloudsByName) {
  TemporaryFolder folder;
  for (const char* name : {"10.bin", "2.bin", "1.BIN", ".3.bin.77.tmp", ".4.bin", "poses.txt",
                           "05.csv", "calib/9.bin"}) {
    write_text(folder / ("in/" + std::string(name)), "x");
  }
  EXPECT_EQ(collected(folder, {"in"}), (Names{"in/1.BIN", "in/10.bin", "in/2.bin"}));
  EXPECT_EQ(collected(folder, {"in/2.bin", "in/10.bin"}), (Names{"in/2.bin", "in/10.bin"}));
}

TEST(Inputs, DriveAndKittiFoldersStandForTheirSweeps) {
  TemporaryFolder folder;
  for (const char* name :
       {"drive/sweeps/0.pcd", "drive/sweeps/1.pcd", "drive/mesh.ply", "drive/poses.txt",
        "kitti/velodyne/2.bin", "kitti/calib.txt", "raw/velodyne_points/data/3.bin",
        "raw/velodyne_points/timestamps.txt"}) {
    write_text(folder / name, "x");
  }
  EXPECT_EQ(collected(folder, {"drive", "kitti", "raw"}),
            (Names{"drive/sweeps/0.pcd", "drive/sweeps/1.pcd", "kitti/velodyne/2.bin",
                   "raw/velodyne_points/data/3.bin"}));
  write_text(folder / "drive/scan.ply", "x");
  expect_error(failure(folder, {"drive"}), ErrorCode::invalid_argument, "more of them in sweeps/");
}

TEST(Inputs, MeshAloneIsACloud) {
  TemporaryFolder folder;
  write_text(folder / "in/mesh.ply", "x");
  EXPECT_EQ(collected(folder, {"in"}), Names{"in/mesh.ply"});
}

TEST(Inputs, NamesWhatIsWrong) {
  TemporaryFolder folder;
  for (const char* name :
       {"mixed/a.bin", "mixed/b.pcd", "a/1.bin", "b/1.pcd", "none/poses.txt", "twice/a.bin",
        "twice/b.bin", "twice/b.ply", "twice/b2.bin", "drive/sweeps/readme.txt", "out.sweep"}) {
    write_text(folder / name, "x");
  }
  const auto invalid = ErrorCode::invalid_argument;
  expect_error(failure(folder, {"gone"}), ErrorCode::not_found, "gone: does not exist");
  expect_error(failure(folder, {"mixed"}), invalid, "both .bin and .pcd");
  EXPECT_EQ(collected(folder, {"mixed/a.bin", "mixed/b.pcd"}).size(), 2U);
  expect_error(failure(folder, {"twice"}), invalid, "b.bin and b.ply, which stand for the same");
  expect_error(failure(folder, {"none"}), invalid, "holds no cloud");
  expect_error(failure(folder, {"drive"}), invalid, "sweeps: holds no cloud");
  expect_error(failure(folder, {"out.sweep"}), invalid, "out.sweep: is not named as a cloud");
  expect_error(failure(folder, {"a", "b"}), invalid, (folder / "a/1.bin").string());
  expect_error(failure(folder, {"a", "b"}), invalid, (folder / "b/1.pcd").string());
  expect_error(failure(folder, {"a", "a/1.bin"}), invalid, "a/1.bin: is given twice; name it once");
}

}  // namespace
}  // namespace sweepcast::app
