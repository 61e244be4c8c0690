// True boxes as others' data sets have them.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "lab/detect/boxes.hpp"
#include "lab/odometry/rigid.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// What is known of one sweep's boxes, in the sensor's frame.
struct Labels {
  std::vector<Box> boxes;
  /// Whether a box at this place would have been labelled; empty: anywhere.
  std::function<bool(const Eigen::Vector3d&)> is_labelled;
};

/// A camera and where it stands, from a KITTI calibration file.
struct KittiCalibration {
  Eigen::Matrix<double, 3, 4> image;  ///< P2: from the rectified camera's frame to pixels
  RigidTransform camera;              ///< from the LiDAR's frame to the rectified camera's
};

/// Reads the text of a calibration file: its lines P2, R0_rect and Tr_velo_to_cam. `name` begins
/// the messages. Errors: corrupt (a line absent, or without its numbers, or no rotation).
[[nodiscard]] Result<KittiCalibration> parse_kitti_calibration(std::string_view text,
                                                               const std::string& name);

/// Reads the text of a label_2 file. Labelled is what the camera sees, but for the regions
/// "DontCare" of its image. Errors: corrupt.
[[nodiscard]] Result<Labels> parse_kitti_labels(std::string_view text,
                                                const KittiCalibration& calibration,
                                                const std::string& name);

/// Reads the text of PandaSet's cuboids, a table with a head. `pose` takes points from the sensor
/// to the world, in which they are. Errors: corrupt (a column absent, a row that is no cuboid).
[[nodiscard]] Result<Labels> parse_pandaset_cuboids(std::string_view text,
                                                    const RigidTransform& pose,
                                                    const std::string& name);

/// Reads the boxes of the sweep whose file has the name `stem`, of which the folder may hold
///   STEM.txt, as `simulate` writes it;
///   STEM.txt, as KITTI's label_2 has it (15 or 16 words a line), with ../calib/STEM.txt;
///   STEM.csv, as PandaSet has it, with poses.txt, a line for each .csv file in order.
/// Errors: not_found, io, corrupt, limit.
[[nodiscard]] Result<Labels> read_labels(const std::filesystem::path& folder,
                                         const std::string& stem);

}  // namespace sweepcast::lab
