#include "common/inputs.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <system_error>

namespace sweepcast::app {
namespace {

namespace fs = std::filesystem;

using Paths = std::vector<fs::path>;

/// Where the sweeps lie in the folders that people keep: a drive of `simulate`, KITTI's detection
/// and odometry sets, KITTI's raw recordings.
constexpr const char* kSweepFolders[] = {"sweeps", "velodyne", "velodyne_points/data"};

tl::unexpected<Error> invalid(const fs::path& path, const std::string& what) {
  return fail(ErrorCode::invalid_argument, path.string() + ": " + what);
}

/// The clouds in a folder itself, by name. A mesh beside the sweeps of a drive is none.
Result<Paths> clouds_in(const fs::path& folder, bool is_drive) {
  Paths clouds;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const fs::path& path = at->path();
    if (!cloud_format_of(path) || at->is_directory()) continue;
    if (path.filename().string().front() == '.') continue;  // unfinished, or a system's own
    if (is_drive && path.filename() == "mesh.ply") continue;
    clouds.push_back(path);
  }
  if (error) {
    return fail(ErrorCode::io, folder.string() + ": cannot be listed (" + error.message() +
                                   "); check its permissions");
  }
  std::sort(clouds.begin(), clouds.end());
  return clouds;
}

/// Two formats of the same sweep, which are neighbours by name, have a message of their own.
Status check_one_format(const fs::path& folder, const Paths& clouds) {
  for (std::size_t i = 1; i < clouds.size(); ++i) {
    if (clouds[i].stem() != clouds[i - 1].stem()) continue;
    return invalid(folder, "holds " + clouds[i - 1].filename().string() + " and " +
                               clouds[i].filename().string() +
                               ", which stand for the same sweep; remove one kind, or part them "
                               "into folders");
  }
  for (const fs::path& cloud : clouds) {
    const auto first = name(*cloud_format_of(clouds.front()));
    const auto other = name(*cloud_format_of(cloud));
    if (first == other) continue;
    return invalid(folder, "holds both ." + std::string(first) + " and ." + std::string(other) +
                               " files; name the files of one kind, or part them into folders");
  }
  return {};
}

Result<Paths> clouds_of_folder(const fs::path& folder) {
  std::optional<fs::path> sweeps;
  for (const char* name : kSweepFolders) {
    std::error_code error;
    if (!sweeps && fs::is_directory(folder / name, error)) sweeps = folder / name;
  }
  auto clouds = clouds_in(folder, sweeps.has_value());
  if (!clouds) return clouds;
  if (sweeps && !clouds->empty()) {
    return invalid(folder, "holds clouds, and more of them in " + sweeps->filename().string() +
                               "/; name the folder you mean, or the files");
  }
  if (sweeps) clouds = clouds_in(*sweeps, false);
  if (!clouds) return clouds;
  const fs::path& searched = sweeps ? *sweeps : folder;
  if (clouds->empty()) {
    return invalid(searched, "holds no cloud; name a folder with .bin, .pcd or .ply files");
  }
  if (Status status = check_one_format(searched, *clouds); !status) {
    return tl::unexpected(status.error());
  }
  return clouds;
}

Result<Paths> clouds_of(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    return fail(ErrorCode::not_found, path.string() + ": does not exist; check the path");
  }
  if (error) {
    return fail(ErrorCode::io, path.string() + ": cannot be looked at (" + error.message() +
                                   "); check its permissions");
  }
  if (fs::is_directory(status)) return clouds_of_folder(path);
  if (cloud_format_of(path)) return Paths{path};
  return invalid(path, "is not named as a cloud; clouds end in .bin, .pcd or .ply");
}

}  // namespace

Result<std::vector<fs::path>> collect_clouds(const std::vector<std::string>& inputs) {
  Paths all;
  for (const std::string& input : inputs) {
    auto clouds = clouds_of(input);
    if (!clouds) return clouds;
    all.insert(all.end(), clouds->begin(), clouds->end());
  }
  std::map<std::string, fs::path> by_name;  // decoding makes a file of each base name
  for (const fs::path& cloud : all) {
    const auto [other, is_new] = by_name.emplace(cloud.stem().string(), cloud);
    if (is_new) continue;
    std::error_code ignored;
    if (fs::equivalent(cloud, other->second, ignored)) {
      return invalid(cloud, "is given twice; name it once");
    }
    return invalid(cloud, "has the same base name as " + other->second.string() +
                              ", so that one would overwrite the other when decoded; rename one, "
                              "or encode them apart");
  }
  return all;
}

Status check_output(const fs::path& output, const Paths& reads) {
  for (const fs::path& read : reads) {
    std::error_code ignored;  // what is not there is not the same
    if (!read.empty() && fs::equivalent(output, read, ignored)) {
      return fail(ErrorCode::invalid_argument,
                  output.string() +
                      ": is read by this command and would be overwritten; "
                      "give another output");
    }
  }
  return {};
}

}  // namespace sweepcast::app
