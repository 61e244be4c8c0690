// Boxes about cars, vans and people, and the files that hold them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lab/odometry/rigid.hpp"
#include "sweepcast/cloud.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// A box that stands upright: length along its own x axis, height along z. Metres, in the frame of
/// the sensor (x forward, y left, z up) unless said otherwise.
struct Box {
  std::string label = "Car";
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of the box, not of its floor
  double length = 0.0, width = 0.0, height = 0.0;
  double yaw = 0.0;    ///< radians from the frame's x axis, counter-clockwise about z
  int points = -1;     ///< that were measured on it; -1: not counted
  double score = 1.0;  ///< of a box that was found, 0 to 1
};

/// Reads what `simulate` and `detect` write: a line a box, `label x y z length width height yaw
/// points`, and a score where it was found. Lines may end in "\r\n"; empty ones count not.
/// Errors: not_found, io, corrupt (a line that is no box: sizes must be above 0, coordinates within
/// 10 km), limit (over 64 MiB).
[[nodiscard]] Result<std::vector<Box>> read_boxes(const std::filesystem::path& file);
/// The same of a text; `name` begins the messages.
[[nodiscard]] Result<std::vector<Box>> parse_boxes(std::string_view text, const std::string& name);

/// Writes them in that form, with scores. Errors: io.
[[nodiscard]] Status write_boxes(const std::filesystem::path& file, std::span<const Box> boxes);

/// Counts the points inside each box, and gives it to the boxes as `points`. Points on the ground
/// under a box count not: those in its lowest 10 cm.
void count_points(const PointCloud& cloud, std::span<Box> boxes);

}  // namespace sweepcast::lab
