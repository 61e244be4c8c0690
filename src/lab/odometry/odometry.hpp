// LiDAR odometry: where the sensor was at each sweep, from the sweeps alone.
//
// Follows KISS-ICP (Vizzo et al., IEEE RA-L 2023): constant-velocity prediction and deskewing, two
// voxel grids, an adaptive threshold, point-to-point ICP against a voxel map. Three differences:
//   - Of a cube's points the one nearest to a random place in it stays, not the first, so that two
//     codecs that give the same points in another order give the same path.
//   - A map of coarse cubes finds the place, and finer ones refine it. Alone, a fine map holds on
//     to the rings on the ground, which look as if the sensor stood still.
//   - The first two sweeps are deskewed by the motion found between them, over and over; else the
//     first one's points, put askew, pull at all that follow.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lab/odometry/registration.hpp"
#include "lab/odometry/rigid.hpp"
#include "lab/odometry/voxel_map.hpp"
#include "sweepcast/cloud.hpp"

namespace sweepcast::lab {

struct OdometryOptions {
  double min_range_m = 3.0;  ///< nearer points are the robot itself
  double max_range_m = 100.0;
  double voxel_m = 1.0;  ///< the finest map's cubes; a hundredth of the range
  double initial_threshold_m = 2.0;
  double min_motion_m = 0.1;  ///< smaller corrections do not teach the threshold
};

/// A sensor that moves. Feed sweeps in the order of their time.
class Odometry {
 public:
  explicit Odometry(const OdometryOptions& options);

  /// Registers a sweep whose points are in the sensor's frame. `when` says at which share of the
  /// sweep each point was measured (0: first firing, 1: last), or is empty where the points are
  /// deskewed already. NaN and infinite points are passed over. Returns the sensor's pose at the
  /// last firing (deskewed sweeps: in their frame) in that of the first sweep.
  RigidTransform add(const PointCloud& cloud, std::span<const float> when);

  /// The poses so far, one a sweep.
  [[nodiscard]] const std::vector<RigidTransform>& poses() const { return poses_; }

  /// How many of the sweeps had no point in range; motion goes on there as before.
  [[nodiscard]] std::size_t empty_sweeps() const { return empty_sweeps_; }

 private:
  /// Points in the sensor's frame and their share of the sweep, as many or none.
  struct Sweep {
    Points points;
    std::vector<float> when;
  };

  using Layers = std::vector<Points>;  ///< a sweep's points for each of the maps

  [[nodiscard]] RigidTransform predicted_motion() const;
  [[nodiscard]] Sweep in_range(const PointCloud& cloud, std::span<const float> when) const;
  [[nodiscard]] RigidTransform first_motion(const Sweep& second);
  [[nodiscard]] Layers thinned(const Points& points, std::uint64_t number) const;
  [[nodiscard]] RigidTransform find(const Layers& layers, RigidTransform pose) const;
  void insert(Layers layers, const RigidTransform& pose);
  void learn_threshold(const RigidTransform& correction);

  OdometryOptions options_;
  std::vector<VoxelMap> maps_;  ///< each of cubes half as wide as the one before
  Sweep first_;                 ///< until the second has come
  std::vector<RigidTransform> poses_;
  std::size_t empty_sweeps_ = 0;
  double squared_corrections_ = 0.0;
  int corrections_ = 0;
  double threshold_m_;
};

}  // namespace sweepcast::lab
