#include "lab/evaluate/drive.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <system_error>
#include <utility>

#include "io/file.hpp"
#include "lab/evaluate/content_hash.hpp"
#include "lab/odometry/trajectory.hpp"

namespace sweepcast::lab {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestInput = std::size_t{1} << 30;

bool is_there(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error);
}

Status find_poses(DriveFiles& drive) {
  const fs::path file = drive.folder / "poses.txt";
  if (!is_there(file)) return {};
  auto poses = read_poses(file);
  if (!poses) return tl::unexpected(std::move(poses.error()));
  if (poses->size() < drive.sweeps.size()) {
    return fail(ErrorCode::invalid_argument,
                fmt::format("{}: {} poses for {} sweeps; give the poses of this drive, or move the "
                            "file elsewhere",
                            file.string(), poses->size(), drive.sweeps.size()));
  }
  poses->resize(drive.sweeps.size());
  ContentHash hash;
  for (const RigidTransform& pose : *poses) hash.add(std::as_bytes(std::span(pose.data(), 16)));
  drive.poses = std::move(*poses);
  drive.poses_hash = hash.hex();
  return {};
}

}  // namespace

Result<std::string> hash_file(const fs::path& file) {
  std::vector<std::byte> bytes;
  if (Status read = read_file(file, kLargestInput, bytes); !read) {
    return tl::unexpected(std::move(read.error()));
  }
  return ContentHash().add(bytes).hex();
}

Result<DriveFiles> open_drive(fs::path folder, std::vector<fs::path> sweeps) {
  DriveFiles drive;
  drive.folder = std::move(folder);
  drive.sweeps = std::move(sweeps);
  if (drive.sweeps.empty()) {
    return fail(ErrorCode::invalid_argument,
                drive.folder.string() + ": holds no sweep; name a folder of sweeps");
  }
  if (Status found = find_poses(drive); !found) return tl::unexpected(std::move(found.error()));
  if (const fs::path mesh = drive.folder / "mesh.ply"; is_there(mesh)) drive.mesh = mesh;
  ContentHash hash;
  std::vector<std::byte> bytes;
  for (const fs::path& sweep : drive.sweeps) {
    if (Status read = read_file(sweep, kLargestInput, bytes); !read) {
      return tl::unexpected(std::move(read.error()));
    }
    hash.add(bytes);
  }
  drive.sweeps_hash = hash.hex();
  return drive;
}

}  // namespace sweepcast::lab
