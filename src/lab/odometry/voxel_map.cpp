#include "lab/odometry/voxel_map.hpp"

#include <algorithm>
#include <cmath>

#include "lab/random.hpp"

namespace sweepcast::lab {

namespace {

constexpr std::size_t kPointsPerVoxel = 20;

Voxel voxel_of(const Eigen::Vector3d& point, double size_m) {
  return (point / size_m).array().floor().cast<int>();
}

// A place in a cube, the same for the same cube and seed.
Eigen::Vector3d place_in(const Voxel& voxel, double size_m, std::uint64_t seed) {
  constexpr double kSteps = 1U << 21U;
  const std::uint64_t bits = scatter(seed ^ scatter(VoxelHash{}(voxel)));
  const Eigen::Vector3d share(static_cast<double>(bits & 0x1fffffU),
                              static_cast<double>((bits >> 21U) & 0x1fffffU),
                              static_cast<double>((bits >> 42U) & 0x1fffffU));
  return size_m * (voxel.cast<double>() + share / kSteps);
}

}  // namespace

// Teschner et al., Optimized Spatial Hashing for Collision Detection of Deformable Objects, 2003.
std::size_t VoxelHash::operator()(const Voxel& voxel) const noexcept {
  const auto spread = [](int i, std::uint32_t prime) {
    return static_cast<std::uint32_t>(i) * prime;
  };
  return spread(voxel.x(), 73856093U) ^ spread(voxel.y(), 19349669U) ^ spread(voxel.z(), 83492791U);
}

Points thin_by_voxel(std::span<const Eigen::Vector3d> points, double size_m, std::uint64_t seed) {
  struct Kept {
    std::size_t place;
    double distance;
  };
  tsl::robin_map<Voxel, Kept, VoxelHash> cubes;
  cubes.reserve(points.size() / 4);
  Points kept;
  for (const Eigen::Vector3d& point : points) {
    const Voxel voxel = voxel_of(point, size_m);
    const double distance = (point - place_in(voxel, size_m, seed)).squaredNorm();
    const auto [cube, is_new] = cubes.try_emplace(voxel, Kept{kept.size(), distance});
    if (is_new) {
      kept.push_back(point);
    } else if (distance < cube->second.distance) {
      cube.value().distance = distance;
      kept[cube->second.place] = point;
    }
  }
  return kept;
}

VoxelMap::VoxelMap(double size_m, double range_m) : size_m_(size_m), range_m_(range_m) {}

void VoxelMap::add(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& sensor) {
  const double apart = size_m_ * size_m_ / static_cast<double>(kPointsPerVoxel);
  for (const Eigen::Vector3d& point : points) {
    const auto cube = cubes_.try_emplace(voxel_of(point, size_m_)).first;
    Points& held = cube.value();
    if (held.size() >= kPointsPerVoxel) continue;
    const bool is_near = std::any_of(held.begin(), held.end(), [&](const Eigen::Vector3d& other) {
      return (other - point).squaredNorm() < apart;
    });
    if (!is_near) held.push_back(point);
  }
  for (auto cube = cubes_.begin(); cube != cubes_.end();) {
    const bool far = (cube->second.front() - sensor).squaredNorm() > range_m_ * range_m_;
    cube = far ? cubes_.erase(cube) : std::next(cube);
  }
}

std::optional<Eigen::Vector3d> VoxelMap::nearest(const Eigen::Vector3d& point) const {
  const Voxel middle = voxel_of(point, size_m_);
  std::optional<Eigen::Vector3d> best;
  double best_distance = 0.0;
  for (int i = 0; i < 27; ++i) {
    const auto cube = cubes_.find(middle + Voxel(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
    if (cube == cubes_.end()) continue;
    for (const Eigen::Vector3d& other : cube->second) {
      const double distance = (other - point).squaredNorm();
      if (best && distance >= best_distance) continue;
      best = other;
      best_distance = distance;
    }
  }
  return best;
}

std::size_t VoxelMap::size() const {
  std::size_t count = 0;
  for (const auto& cube : cubes_) count += cube.second.size();
  return count;
}

}  // namespace sweepcast::lab
