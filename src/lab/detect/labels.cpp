#include "lab/detect/labels.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <system_error>

#include "io/file.hpp"
#include "io/text.hpp"
#include "lab/odometry/trajectory.hpp"

namespace sweepcast::lab {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostLabelBytes = std::size_t{1} << 26U;

/// A rectangle of an image, pixels.
struct Region {
  double left, top, right, bottom;
};

// All words as numbers that a place or a size may be; none where one is not.
std::optional<std::vector<double>> numbers_of(std::span<const std::string_view> words) {
  std::vector<double> numbers;
  for (const std::string_view word : words) {
    const auto number = number_of<double>(word);
    if (!number || !(std::abs(*number) <= 1e6)) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

// The numbers of the line that begins with `key`; empty where it is not there, or has others.
std::vector<double> calibration_line(std::string_view text, std::string_view key,
                                     std::size_t count) {
  LineReader lines(text);
  while (const auto line = lines.next()) {
    const auto words = words_of(*line);
    if (words.size() != count + 1 || words[0] != key) continue;
    return numbers_of(std::span(words).subspan(1)).value_or(std::vector<double>());
  }
  return {};
}

template <int kColumns>
Eigen::Matrix<double, 3, kColumns> matrix_of(const std::vector<double>& numbers) {
  return Eigen::Map<const Eigen::Matrix<double, 3, kColumns, Eigen::RowMajor>>(numbers.data());
}

bool is_rotation(const Eigen::Matrix3d& matrix) {
  return (matrix * matrix.transpose()).isIdentity(1e-3) && matrix.determinant() > 0.0;
}

double yaw_of(const Eigen::Vector3d& direction) {
  return std::atan2(direction.y(), direction.x());
}

bool has_size(const Box& box) {
  return box.length > 0.0 && box.width > 0.0 && box.height > 0.0;
}

// A line of label_2: type, truncated, occluded, alpha, the box in the image (4), height, width,
// length, the middle of the box's floor in the camera's frame (3), the turn about its y axis.
struct KittiLine {
  Region image;
  std::optional<Box> box;  ///< none of "DontCare"
};

std::optional<KittiLine> parse_kitti_line(std::string_view line, const RigidTransform& to_lidar) {
  const auto words = words_of(line);
  if (words.size() != 15 && words.size() != 16) return {};
  const auto n = numbers_of(std::span(words).subspan(1));
  if (!n) return {};
  KittiLine parsed{{(*n)[3], (*n)[4], (*n)[5], (*n)[6]}, {}};
  if (words[0] == "DontCare") return parsed;
  Box box;
  box.label = words[0];
  box.height = (*n)[7];
  box.width = (*n)[8];
  box.length = (*n)[9];
  if (!has_size(box)) return {};
  const double turn = (*n)[13];
  box.centre = to_lidar * Eigen::Vector3d((*n)[10], (*n)[11] - 0.5 * box.height, (*n)[12]);
  box.yaw = yaw_of(to_lidar.linear() * Eigen::Vector3d(std::cos(turn), 0.0, -std::sin(turn)));
  parsed.box = std::move(box);
  return parsed;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

Result<std::string> read_text(const fs::path& file) {
  std::vector<std::byte> bytes;
  if (Status read = read_file(file, kMostLabelBytes, bytes); !read)
    return tl::unexpected(read.error());
  return std::string(as_text(bytes));
}

// Poses are in the order of the tables' names.
Result<RigidTransform> pose_beside(const fs::path& table) {
  const auto poses = read_poses(table.parent_path() / "poses.txt");
  if (!poses) return tl::unexpected(poses.error());
  std::size_t before = 0;
  std::error_code error;
  for (fs::directory_iterator at(table.parent_path(), error), end; !error && at != end;
       at.increment(error)) {
    if (at->path().extension() == ".csv" && at->path().filename() < table.filename()) ++before;
  }
  if (before >= poses->size()) {
    return fail(ErrorCode::corrupt, table.string() +
                                        ": poses.txt beside it has no line for it; "
                                        "give a pose for each .csv file");
  }
  return (*poses)[before];
}

}  // namespace

Result<KittiCalibration> parse_kitti_calibration(std::string_view text, const std::string& name) {
  const auto image = calibration_line(text, "P2:", 12);
  const auto rectified = calibration_line(text, "R0_rect:", 9);
  const auto camera = calibration_line(text, "Tr_velo_to_cam:", 12);
  if (image.empty() || rectified.empty() || camera.empty()) {
    return fail(ErrorCode::corrupt, name +
                                        ": lacks P2, R0_rect or Tr_velo_to_cam with 12, 9 and "
                                        "12 numbers; give a calibration of KITTI's object set");
  }
  KittiCalibration calibration;
  calibration.image = matrix_of<4>(image);
  const Eigen::Matrix3d turn = matrix_of<3>(rectified);
  const Eigen::Matrix<double, 3, 4> to_camera = matrix_of<4>(camera);
  if (!is_rotation(turn) || !is_rotation(to_camera.leftCols<3>())) {
    return fail(ErrorCode::corrupt,
                name + ": R0_rect or Tr_velo_to_cam is no rotation; copy the file again");
  }
  calibration.camera = RigidTransform::Identity();
  calibration.camera.linear() = turn * to_camera.leftCols<3>();
  calibration.camera.translation() = turn * to_camera.col(3);
  return calibration;
}

Result<Labels> parse_kitti_labels(std::string_view text, const KittiCalibration& calibration,
                                  const std::string& name) {
  const Eigen::Matrix3d turn = calibration.camera.linear().inverse();
  RigidTransform to_lidar = RigidTransform::Identity();
  to_lidar.linear() = turn;
  to_lidar.translation() = -(turn * calibration.camera.translation());
  Labels labels;
  std::vector<Region> unlabelled;
  LineReader lines(text);
  while (const auto line = lines.next()) {
    if (words_of(*line).empty()) continue;
    auto parsed = parse_kitti_line(*line, to_lidar);
    if (!parsed) {
      return fail(ErrorCode::corrupt,
                  fmt::format("{}: line {} is no label; give lines of KITTI's label_2", name,
                              lines.line()));
    }
    if (parsed->box) {
      labels.boxes.push_back(std::move(*parsed->box));
    } else {
      unlabelled.push_back(parsed->image);
    }
  }
  labels.is_labelled = [calibration, unlabelled](const Eigen::Vector3d& place) {
    constexpr double kWidth = 1242.0, kHeight = 375.0;  // pixels of KITTI's images
    const Eigen::Vector3d seen = calibration.image * (calibration.camera * place).homogeneous();
    if (!(seen.z() > 0.1)) return false;
    const double u = seen.x() / seen.z(), v = seen.y() / seen.z();
    if (!(u >= 0.0 && u < kWidth && v >= 0.0 && v < kHeight)) return false;
    return std::none_of(unlabelled.begin(), unlabelled.end(), [&](const Region& region) {
      return u >= region.left && u <= region.right && v >= region.top && v <= region.bottom;
    });
  };
  return labels;
}

Result<Labels> parse_pandaset_cuboids(std::string_view text, const RigidTransform& pose,
                                      const std::string& name) {
  constexpr std::array<std::string_view, 8> kColumns{"label",        "yaw",         "position.x",
                                                     "position.y",   "position.z",  "dimensions.x",
                                                     "dimensions.y", "dimensions.z"};
  LineReader lines(text);
  const auto head = cells_of(lines.next().value_or(std::string_view()));
  std::array<std::size_t, kColumns.size()> at{};
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    const auto found = std::find(head.begin(), head.end(), kColumns[i]);
    if (found == head.end()) {
      return fail(ErrorCode::corrupt,
                  fmt::format("{}: has no column {}; give PandaSet's cuboids", name, kColumns[i]));
    }
    at[i] = static_cast<std::size_t>(found - head.begin());
  }
  Labels labels;
  const RigidTransform to_sensor = pose.inverse();
  while (const auto line = lines.next()) {
    if (line->empty()) continue;
    const auto cells = cells_of(*line);
    std::array<std::string_view, kColumns.size()> words;
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (at[i] < cells.size()) words[i] = cells[at[i]];
    }
    const auto n = numbers_of(std::span<const std::string_view>(words).subspan(1));
    Box box;
    if (n) {
      box.label = words[0];
      const double ahead = (*n)[0] + 0.5 * std::numbers::pi;  // its y axis is the length's
      box.centre = to_sensor * Eigen::Vector3d((*n)[1], (*n)[2], (*n)[3]);
      box.yaw = yaw_of(to_sensor.linear() * Eigen::Vector3d(std::cos(ahead), std::sin(ahead), 0.0));
      box.width = (*n)[4];
      box.length = (*n)[5];
      box.height = (*n)[6];
    }
    if (!n || !has_size(box)) {
      return fail(ErrorCode::corrupt,
                  fmt::format("{}: line {} is no cuboid; copy the file again", name, lines.line()));
    }
    labels.boxes.push_back(std::move(box));
  }
  return labels;
}

Result<Labels> read_labels(const fs::path& folder, const std::string& stem) {
  std::error_code error;
  const fs::path table = folder / (stem + ".csv");
  if (fs::exists(table, error)) {
    const auto text = read_text(table);
    if (!text) return tl::unexpected(text.error());
    const auto pose = pose_beside(table);
    if (!pose) return tl::unexpected(pose.error());
    return parse_pandaset_cuboids(*text, *pose, table.string());
  }
  const fs::path file = folder / (stem + ".txt");
  const auto text = read_text(file);
  if (!text) return tl::unexpected(text.error());
  LineReader lines(*text);
  const auto words = words_of(lines.next().value_or(std::string_view()));
  if (words.size() < 15) {
    auto boxes = parse_boxes(*text, file.string());
    if (!boxes) return tl::unexpected(boxes.error());
    return Labels{std::move(*boxes), {}};
  }
  const fs::path calib = fs::absolute(folder, error).lexically_normal();
  const fs::path parent =
      calib.has_filename() ? calib.parent_path() : calib.parent_path().parent_path();
  const fs::path calibration_file = parent / "calib" / (stem + ".txt");
  const auto calibration_text = read_text(calibration_file);
  if (!calibration_text) return tl::unexpected(calibration_text.error());
  const auto calibration = parse_kitti_calibration(*calibration_text, calibration_file.string());
  if (!calibration) return tl::unexpected(calibration.error());
  return parse_kitti_labels(*text, *calibration, file.string());
}

}  // namespace sweepcast::lab
