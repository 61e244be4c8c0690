#include "lab/mesh/seen_space.hpp"

namespace sweepcast::lab {

namespace {

constexpr int kBlockBits = 2;  // 4 cubes a side
constexpr int kBlockMask = (1 << kBlockBits) - 1;

Voxel cube_of(const Eigen::Vector3d& point, double cube_m) {
  return (point / cube_m).array().floor().cast<int>();
}

Voxel block_of(const Voxel& cube) {
  return {cube.x() >> kBlockBits, cube.y() >> kBlockBits, cube.z() >> kBlockBits};
}

std::uint64_t bit_of(const Voxel& cube) {
  const int index =
      (((cube.z() & kBlockMask) << kBlockBits | (cube.y() & kBlockMask)) << kBlockBits) |
      (cube.x() & kBlockMask);
  return std::uint64_t{1} << static_cast<unsigned>(index);
}

}  // namespace

void SeenSpace::add(std::span<const Ray> rays) {
  for (const Ray& ray : rays) {
    const Voxel cube = cube_of(ray.end, cube_m_);
    blocks_[block_of(cube)] |= bit_of(cube);
  }
}

bool SeenSpace::is_seen(const Eigen::Vector3d& point) const {
  const Voxel middle = cube_of(point, cube_m_);
  for (int i = 0; i < 27; ++i) {
    const Voxel cube = middle + Voxel(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    const auto block = blocks_.find(block_of(cube));
    if (block != blocks_.end() && (block->second & bit_of(cube)) != 0) return true;
  }
  return false;
}

}  // namespace sweepcast::lab
