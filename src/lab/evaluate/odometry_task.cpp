// Odometry as a task: how far the path that is found from decoded sweeps is from the true one.
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lab/evaluate/tasks.hpp"
#include "lab/odometry/odometry.hpp"
#include "lab/odometry/trajectory.hpp"

namespace sweepcast::lab {
namespace {

class OdometryRun : public TaskRun {
 public:
  explicit OdometryRun(std::span<const RigidTransform> truth)
      : truth_(truth), odometry_(OdometryOptions{}) {}

  Status add(const SweepPair& sweep) override {
    odometry_.add(sweep.decoded, sweep.when);
    return {};
  }

  Result<Figures> finish() override {
    const auto error = trajectory_error(truth_, odometry_.poses());
    if (!error) return tl::unexpected(error.error());
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const bool is_long = error->stretches > 0;
    return Figures{
        {"translation_error_percent", is_long ? error->translation_percent : kNone},
        {"rotation_error_deg_per_m", is_long ? error->rotation_deg_per_m : kNone},
        {"step_translation_m", error->step_translation_m},
    };
  }

 private:
  std::span<const RigidTransform> truth_;
  Odometry odometry_;
};

class OdometryTask : public Task {
 public:
  explicit OdometryTask(const DriveFiles& drive)
      : Task("odometry", "poses " + drive.poses_hash, 1), truth_(drive.poses) {}

  Result<std::unique_ptr<TaskRun>> begin() const override {
    return std::make_unique<OdometryRun>(truth_);
  }

 private:
  std::vector<RigidTransform> truth_;
};

}  // namespace

Result<std::unique_ptr<const Task>> make_odometry_task(const DriveFiles& drive,
                                                       const TaskOptions& /*options*/) {
  if (drive.poses.empty()) {
    return fail(ErrorCode::not_found,
                drive.folder.string() +
                    ": has no poses.txt, and the path that odometry finds on the uncoded sweeps "
                    "would hide its own errors; put the true poses there, a KITTI line a sweep");
  }
  if (drive.sweeps.size() < 2) {
    return fail(ErrorCode::not_found,
                drive.folder.string() + ": has one sweep, which is no path; give more");
  }
  return std::make_unique<OdometryTask>(drive);
}

}  // namespace sweepcast::lab
