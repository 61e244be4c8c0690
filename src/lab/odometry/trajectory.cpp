#include "lab/odometry/trajectory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

#include "io/file.hpp"
#include "io/text.hpp"

namespace sweepcast::lab {

namespace {

constexpr std::array<double, 8> kStretches = {100, 200, 300, 400, 500, 600, 700, 800};  // metres
constexpr std::size_t kStartEvery = 10;                                                 // sweeps
constexpr double kDegrees = 180.0 / std::numbers::pi;

double angle_of(const RigidTransform& motion) {
  return std::acos(std::clamp((motion.linear().trace() - 1.0) / 2.0, -1.0, 1.0));
}

std::vector<double> distances_along(std::span<const RigidTransform> path) {
  std::vector<double> distances{0.0};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const auto step = path[i].translation() - path[i - 1].translation();
    distances.push_back(distances.back() + step.norm());
  }
  return distances;
}

// What is left of an estimated motion from `first` to `last` where the true one is taken off.
RigidTransform motion_error(std::span<const RigidTransform> truth,
                            std::span<const RigidTransform> estimate, std::size_t first,
                            std::size_t last) {
  const RigidTransform wanted = truth[first].inverse() * truth[last];
  const RigidTransform found = estimate[first].inverse() * estimate[last];
  return found.inverse() * wanted;
}

void measure_stretches(std::span<const RigidTransform> truth,
                       std::span<const RigidTransform> estimate, TrajectoryError& result) {
  const std::vector<double> distances = distances_along(truth);
  result.length_m = distances.back();
  double translation = 0.0, rotation = 0.0;
  for (std::size_t first = 0; first < truth.size(); first += kStartEvery) {
    for (const double length : kStretches) {
      const auto end =
          std::upper_bound(distances.begin(), distances.end(), distances[first] + length);
      if (end == distances.end()) break;
      const auto last = static_cast<std::size_t>(end - distances.begin());
      const RigidTransform error = motion_error(truth, estimate, first, last);
      translation += error.translation().norm() / length;
      rotation += angle_of(error) / length;
      ++result.stretches;
    }
  }
  if (result.stretches == 0) return;
  result.translation_percent = 100.0 * translation / result.stretches;
  result.rotation_deg_per_m = kDegrees * rotation / result.stretches;
}

void measure_steps(std::span<const RigidTransform> truth, std::span<const RigidTransform> estimate,
                   TrajectoryError& result) {
  double translation = 0.0, rotation = 0.0;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const RigidTransform error = motion_error(truth, estimate, i - 1, i);
    translation += error.translation().squaredNorm();
    rotation += angle_of(error) * angle_of(error);
  }
  const auto steps = static_cast<double>(truth.size() - 1);
  result.step_translation_m = std::sqrt(translation / steps);
  result.step_rotation_deg = kDegrees * std::sqrt(rotation / steps);
}

// A line's pose; nothing where it holds none.
std::optional<RigidTransform> parse_pose(std::string_view line) {
  constexpr double kOrthonormal = 1e-3;  // files round to a few digits
  const std::vector<std::string_view> words = words_of(line);
  if (words.size() != 12) return {};
  RigidTransform pose = RigidTransform::Identity();
  for (int i = 0; i < 12; ++i) {
    const auto number = number_of<double>(words[static_cast<std::size_t>(i)]);
    if (!number || !std::isfinite(*number)) return {};
    pose(i / 4, i % 4) = *number;
  }
  const Eigen::Matrix3d square = pose.linear() * pose.linear().transpose();
  const bool is_rotation = square.isIdentity(kOrthonormal) && pose.linear().determinant() > 0.0;
  if (!is_rotation) return {};
  pose.linear() = Eigen::Quaterniond(pose.linear()).normalized().toRotationMatrix();
  return pose;
}

}  // namespace

Result<std::vector<RigidTransform>> read_poses(const std::filesystem::path& file) {
  constexpr std::size_t kCap = std::size_t{1} << 30U;
  std::vector<std::byte> bytes;
  if (Status read = read_file(file, kCap, bytes); !read) return tl::unexpected(read.error());
  std::vector<RigidTransform> poses;
  LineReader lines(as_text(bytes));
  while (const auto line = lines.next()) {
    if (words_of(*line).empty()) continue;
    const auto pose = parse_pose(*line);
    if (!pose) {
      return fail(ErrorCode::corrupt,
                  fmt::format("{}: line {} is no pose; give 12 numbers a line, a 3x4 matrix row by "
                              "row whose left part is a rotation",
                              file.string(), lines.line()));
    }
    poses.push_back(*pose);
  }
  return poses;
}

Status write_poses(const std::filesystem::path& file, std::span<const RigidTransform> poses) {
  std::string text;
  for (const RigidTransform& pose : poses) {
    for (int i = 0; i < 12; ++i) {
      fmt::format_to(std::back_inserter(text), "{:.9e}{}", pose(i / 4, i % 4), i < 11 ? ' ' : '\n');
    }
  }
  return write_file(file, std::as_bytes(std::span(text)));
}

Result<TrajectoryError> trajectory_error(std::span<const RigidTransform> truth,
                                         std::span<const RigidTransform> estimate) {
  if (truth.size() != estimate.size() || truth.size() < 2) {
    return fail(ErrorCode::invalid_argument,
                fmt::format("{} true poses and {} estimated ones cannot be compared; give as many "
                            "of both, and at least two",
                            truth.size(), estimate.size()));
  }
  TrajectoryError result;
  measure_stretches(truth, estimate, result);
  measure_steps(truth, estimate, result);
  return result;
}

}  // namespace sweepcast::lab
