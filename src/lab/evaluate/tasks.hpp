// Every task of the evaluation, by name.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lab/evaluate/drive.hpp"
#include "lab/evaluate/task.hpp"

namespace sweepcast::lab {

inline constexpr std::array<std::string_view, 4> kTaskNames{"distortion", "odometry", "mesh",
                                                            "detection"};

/// How much of a drive the tasks take.
struct TaskOptions {
  bool full = false;  ///< all sweeps; else the costly tasks take every fifth or second
  /// Of PointPillars; where they are empty, or this build cannot use them, the detector without
  /// weights is taken.
  std::filesystem::path weights{};
};

/// F-scores and PSNRs against the original: `f_score.0.02` and so on, `d1_psnr`, `d2_psnr`. Of
/// every fifth sweep.
[[nodiscard]] Result<std::unique_ptr<const Task>> make_distortion_task(const DriveFiles& drive,
                                                                       const TaskOptions& options);

/// KITTI's relative errors of the path that odometry finds: `translation_error_percent`,
/// `rotation_error_deg_per_m` (none where the path is shorter than 100 m), and the RMS error from
/// one sweep to the next, `step_translation_m`. Of all sweeps. Error: not_found (no poses).
[[nodiscard]] Result<std::unique_ptr<const Task>> make_odometry_task(const DriveFiles& drive,
                                                                     const TaskOptions& options);

/// F-scores at 10 cm of the surface that the sweeps make at their true poses: `mesh_f10` against
/// that of the uncoded sweeps, `mesh_f10_truth` against what they saw of the true surface, where
/// there is one. Of all sweeps. Errors: not_found (no poses), unsupported (no OpenVDB).
[[nodiscard]] Result<std::unique_ptr<const Task>> make_mesh_task(const DriveFiles& drive,
                                                                 const TaskOptions& options);

/// Average precision of cars seen from above, 40 recall points: `bev_ap50`, `bev_ap70` (overlaps of
/// 0.5 and 0.7). Of every second sweep. The truth is a folder `boxes`, as `simulate` writes it, or
/// `label_2`, as KITTI has it. Error: not_found (no true boxes, or no weights).
[[nodiscard]] Result<std::unique_ptr<const Task>> make_detection_task(const DriveFiles& drive,
                                                                      const TaskOptions& options);

/// The tasks that this drive and this build allow, and why each of the others is left out.
struct TaskChoice {
  Tasks tasks;
  std::vector<std::string> left_out;
};

/// Makes the tasks of these names, in the order of `kTaskNames`. Errors: invalid_argument (no such
/// task); a task's own, but for unsupported and not_found, which leave it out.
[[nodiscard]] Result<TaskChoice> make_tasks(std::span<const std::string> names,
                                            const DriveFiles& drive, const TaskOptions& options);

}  // namespace sweepcast::lab
