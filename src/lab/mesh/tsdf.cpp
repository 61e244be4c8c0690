#include "lab/mesh/tsdf.hpp"

#include <fmt/format.h>
#include <openvdb/math/DDA.h>
#include <openvdb/math/Ray.h>
#include <openvdb/openvdb.h>
#include <tsl/robin_map.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "lab/mesh/marching_cubes.hpp"

namespace sweepcast::lab {

namespace {

using openvdb::Coord;
using Tree = openvdb::Int32Tree;

/// What is known of a cube; all zeros is nothing. Packed as the tree's number: half the memory of
/// two trees of floats, and one look-up instead of two.
struct Cell {
  std::int16_t distance = 0;  ///< to the surface, in kDistanceSteps of the truncation; < 0: inside
  std::uint16_t weight = 0;   ///< rays that updated it
};

constexpr double kDistanceSteps = 32767.0;
constexpr std::uint16_t kMaxWeight = 10'000;
constexpr double kMaxCoordinate = 524'288.0;  // cubes; what fits twice into 21 bits

Cell unpack(std::int32_t packed) {
  return std::bit_cast<Cell>(packed);
}
std::int32_t pack(Cell cell) {
  return std::bit_cast<std::int32_t>(cell);
}

// The running mean of the distances (-1 to 1, in truncations) that rays saw.
void average(Cell& cell, double distance) {
  const double weight = cell.weight;
  const double sum = weight * cell.distance + std::min(distance, 1.0) * kDistanceSteps;
  cell.distance = static_cast<std::int16_t>(std::lround(sum / (weight + 1.0)));
  if (cell.weight < kMaxWeight) ++cell.weight;
}

// The cells that rays have missed, between two known ones: each has the mean over such pairs, so
// that nothing grows beyond what was seen.
Tree fill_gaps(const Tree& tree, int min_weight) {
  const std::array<Coord, 3> axes{Coord(1, 0, 0), Coord(0, 1, 0), Coord(0, 0, 1)};
  Tree filled(0);
  openvdb::tree::ValueAccessor<const Tree> cells(tree);
  openvdb::tree::ValueAccessor<Tree> result(filled);
  const auto fill = [&](const Coord& at) {
    int sum = 0, count = 0;
    for (const Coord& axis : axes) {
      const Cell before = unpack(cells.getValue(at - axis));
      const Cell behind = unpack(cells.getValue(at + axis));
      if (before.weight < min_weight || behind.weight < min_weight) continue;
      sum += before.distance + behind.distance;
      count += 2;
    }
    if (count > 0) result.setValue(at, pack({static_cast<std::int16_t>(sum / count), 1}));
  };
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    for (auto value = leaf->cbeginValueOn(); value; ++value) {
      if (unpack(*value).weight < min_weight) continue;
      for (const Coord& axis : axes) {  // every gap has a known cell before it
        const Coord at = value.getCoord() + axis;
        if (unpack(cells.getValue(at)).weight < min_weight && !result.isValueOn(at)) fill(at);
      }
    }
  }
  return filled;
}

/// The corners of the cube whose first corner is a cell's centre.
struct Corners {
  std::array<float, 8> distance{};
  std::uint8_t inside = 0;  ///< a bit each
};

/// Marching cubes over the cells' centres. Vertices lie on edges between neighbours and are shared.
class SurfaceMaker {
 public:
  SurfaceMaker(const Tree& tree, double voxel_m, int min_weight)
      : known_(tree),
        filled_(fill_gaps(tree, min_weight)),
        cells_(known_),
        filled_cells_(filled_),
        voxel_m_(static_cast<float>(voxel_m)),
        min_weight_(min_weight) {}

  TriangleMesh make() {
    visit(known_);
    visit(filled_);
    return std::move(mesh_);
  }

 private:
  void visit(const Tree& tree) {
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
      for (auto cell = leaf->cbeginValueOn(); cell; ++cell) {
        const Coord at = cell.getCoord();
        Corners corners;
        if (read_corners(at, corners)) add_triangles(at, corners);
      }
    }
  }

  // False where a corner is unknown, or the surface passes by.
  bool read_corners(const Coord& at, Corners& corners) {
    for (int i = 0; i < 8; ++i) {
      const Coord corner = at.offsetBy(i & 1, (i >> 1) & 1, (i >> 2) & 1);
      Cell cell = unpack(cells_.getValue(corner));
      if (cell.weight < min_weight_) cell = unpack(filled_cells_.getValue(corner));
      if (cell.weight == 0) return false;
      corners.distance[static_cast<std::size_t>(i)] = cell.distance;
      if (cell.distance < 0) corners.inside |= static_cast<std::uint8_t>(1U << i);
    }
    return corners.inside != 0 && corners.inside != 255;
  }

  void add_triangles(const Coord& at, const Corners& corners) {
    const CubeCase& cube = cube_case(corners.inside);
    for (std::size_t i = 0; i < cube.count; ++i) {
      std::array<std::uint32_t, 3> triangle{};
      for (std::size_t k = 0; k < 3; ++k) {
        triangle[k] = vertex_on(at, cube.triangles[i][k], corners);
      }
      mesh_.triangles.push_back(triangle);
    }
  }

  std::uint32_t vertex_on(const Coord& at, std::size_t number, const Corners& corners) {
    const CubeEdge edge = kCubeEdge[number];
    const std::size_t end = edge.begin | (1U << edge.axis);
    const Coord begin = at.offsetBy(edge.begin & 1, (edge.begin >> 1) & 1, (edge.begin >> 2) & 1);
    const auto next = static_cast<std::uint32_t>(mesh_.vertices.size());
    const auto [entry, is_new] = numbers_.try_emplace(key_of(begin, edge.axis), next);
    if (is_new) {
      const float from = corners.distance[edge.begin];
      Eigen::Vector3f place(static_cast<float>(begin.x()), static_cast<float>(begin.y()),
                            static_cast<float>(begin.z()));
      place[edge.axis] += from / (from - corners.distance[end]);
      mesh_.vertices.emplace_back((place.array() + 0.5F) * voxel_m_);
    }
    return entry->second;
  }

  // The middle of the edge, in halves of cubes.
  static std::uint64_t key_of(Coord begin, unsigned axis) {
    std::uint64_t key = 0;
    for (unsigned i = 0; i < 3; ++i) {
      const int halves = 2 * begin[i] + (i == axis ? 1 : 0);
      key = (key << 21U) | (static_cast<std::uint32_t>(halves) & 0x1FFFFFU);
    }
    return key;
  }

  struct KeyHash {
    std::size_t operator()(std::uint64_t key) const noexcept {
      return (key * 0x9E3779B97F4A7C15ULL) >> 20U;
    }
  };

  const Tree& known_;
  Tree filled_;
  openvdb::tree::ValueAccessor<const Tree> cells_;
  openvdb::tree::ValueAccessor<const Tree> filled_cells_;
  float voxel_m_;
  int min_weight_;
  TriangleMesh mesh_;
  tsl::robin_map<std::uint64_t, std::uint32_t, KeyHash> numbers_;  ///< of vertices, by edge
};

}  // namespace

struct TsdfVolume::Field {
  TsdfOptions options;
  Tree tree{0};

  void add_ray(openvdb::tree::ValueAccessor<Tree>& cells, const Ray& ray) {
    using Vec = openvdb::Vec3d;
    const double scale = 1.0 / options.voxel_m;  // from here on, lengths are in cubes
    const Eigen::Vector3d origin = ray.origin * scale;
    const Eigen::Vector3d end = ray.end * scale;
    const double length = (end - origin).norm();
    const double farthest = std::max(end.cwiseAbs().maxCoeff(), origin.cwiseAbs().maxCoeff());
    const bool is_usable = length > 0.0 && farthest < kMaxCoordinate;
    if (!is_usable) return;
    const Eigen::Vector3d direction = (end - origin) / length;
    const double truncation = options.truncation_voxels;
    const double near_end = std::max(0.0, length - truncation);
    const openvdb::math::Ray<double> path(Vec(origin.x(), origin.y(), origin.z()),
                                          Vec(direction.x(), direction.y(), direction.z()),
                                          options.carve ? 0.0 : near_end, length + truncation);
    openvdb::math::DDA<openvdb::math::Ray<double>> walk(path);
    do {
      const Coord& at = walk.voxel();
      const Eigen::Vector3d middle(at.x() + 0.5, at.y() + 0.5, at.z() + 0.5);
      const double distance = direction.dot(end - middle) / truncation;
      if (distance <= -1.0) break;
      Cell cell = unpack(cells.getValue(at));
      if (cell.weight == 0 && walk.next() < near_end) continue;  // free space that nobody touched
      average(cell, distance);
      cells.setValue(at, pack(cell));
    } while (walk.step());
  }
};

TsdfVolume::TsdfVolume(std::unique_ptr<Field> field) : field_(std::move(field)) {}
TsdfVolume::~TsdfVolume() = default;
TsdfVolume::TsdfVolume(TsdfVolume&& other) noexcept = default;
TsdfVolume& TsdfVolume::operator=(TsdfVolume&& other) noexcept = default;

Result<TsdfVolume> TsdfVolume::create(const TsdfOptions& options) {
  const bool is_sound = options.voxel_m >= 0.005 && options.voxel_m <= 10.0 &&
                        options.truncation_voxels >= 1.0 && options.truncation_voxels <= 20.0;
  if (!is_sound) {
    return fail(ErrorCode::invalid_argument,
                fmt::format("mesh: voxels of {} m, truncated after {}; give 0.005 to 10 m, and 1 "
                            "to 20 voxels",
                            options.voxel_m, options.truncation_voxels));
  }
  auto field = std::make_unique<Field>();
  field->options = options;
  return TsdfVolume(std::move(field));
}

void TsdfVolume::add(std::span<const Ray> rays) {
  openvdb::tree::ValueAccessor<Tree> cells(field_->tree);
  for (const Ray& ray : rays) field_->add_ray(cells, ray);
}

TriangleMesh TsdfVolume::surface(int min_weight) const {
  return SurfaceMaker(field_->tree, field_->options.voxel_m, std::max(1, min_weight)).make();
}

std::size_t TsdfVolume::memory_bytes() const {
  return field_->tree.memUsage();
}

}  // namespace sweepcast::lab
