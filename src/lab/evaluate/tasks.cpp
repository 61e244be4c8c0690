#include "lab/evaluate/tasks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace sweepcast::lab {
namespace {

using Maker = Result<std::unique_ptr<const Task>> (*)(const DriveFiles&, const TaskOptions&);

constexpr std::array<Maker, kTaskNames.size()> kMakers{make_distortion_task, make_odometry_task,
                                                       make_mesh_task, make_detection_task};

}  // namespace

Result<TaskChoice> make_tasks(std::span<const std::string> names, const DriveFiles& drive,
                              const TaskOptions& options) {
  for (const std::string& name : names) {
    if (std::find(kTaskNames.begin(), kTaskNames.end(), name) != kTaskNames.end()) continue;
    return fail(
        ErrorCode::invalid_argument,
        fmt::format("{}: no such task; give some of distortion, odometry, mesh, detection", name));
  }
  TaskChoice choice;
  for (std::size_t i = 0; i < kTaskNames.size(); ++i) {
    if (std::find(names.begin(), names.end(), kTaskNames[i]) == names.end()) continue;
    auto task = kMakers[i](drive, options);
    if (task) {
      choice.tasks.push_back(std::move(*task));
    } else if (task.error().code == ErrorCode::not_found ||
               task.error().code == ErrorCode::unsupported) {
      choice.left_out.push_back(fmt::format("{}: {}", kTaskNames[i], task.error().message));
    } else {
      return tl::unexpected(std::move(task.error()));
    }
  }
  return choice;
}

}  // namespace sweepcast::lab
