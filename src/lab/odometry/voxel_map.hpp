// The surroundings as odometry remembers them: a few points in each cube of space.
#pragma once

#include <tsl/robin_map.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sweepcast::lab {

/// Index of a cube of space.
using Voxel = Eigen::Vector3i;

struct VoxelHash {
  std::size_t operator()(const Voxel& voxel) const noexcept;
};

using Points = std::vector<Eigen::Vector3d>;  ///< metres

/// One point of each cube of `size_m` that has some: the nearest to a place in the cube that is
/// drawn anew for every cube and `seed`. So the points' order does not decide; and two sweeps with
/// seeds of their own do not agree in their cubes' places, on which registration would lock.
/// Ordered as the cubes' first points are.
[[nodiscard]] Points thin_by_voxel(std::span<const Eigen::Vector3d> points, double size_m,
                                   std::uint64_t seed);

/// Points in cubes, at most 20 in each and none closer than a fraction of the cube to another, with
/// the search for the nearest.
class VoxelMap {
 public:
  /// Cubes of `size_m`; points farther than `range_m` from the sensor are forgotten.
  VoxelMap(double size_m, double range_m);

  /// Adds points, in the map's frame, and forgets what is out of range of `sensor`.
  void add(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& sensor);

  /// The map's nearest point in the cube of `point` and its 26 neighbours, if any.
  [[nodiscard]] std::optional<Eigen::Vector3d> nearest(const Eigen::Vector3d& point) const;

  void clear() { cubes_.clear(); }

  [[nodiscard]] double voxel_m() const { return size_m_; }
  [[nodiscard]] bool empty() const { return cubes_.empty(); }
  [[nodiscard]] std::size_t size() const;  ///< points in all

 private:
  double size_m_;
  double range_m_;
  tsl::robin_map<Voxel, Points, VoxelHash> cubes_;
};

}  // namespace sweepcast::lab
