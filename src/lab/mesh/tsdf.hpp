// Many sweeps become one surface: a truncated signed distance field over a sparse grid.
//
// Follows VDBFusion (Vizzo et al., Sensors 2022): each ray updates the cubes about its end with
// their signed distance to it, averaged over all rays (Curless and Levoy, SIGGRAPH 1996); marching
// cubes finds the surface where the sign changes. Two differences: distances are taken along the
// ray, and a cube that all rays have missed, between two that they have not, takes their mean, so
// that gaps of one cube between a sensor's beams close.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "lab/mesh/sweep_rays.hpp"
#include "lab/mesh/triangle_mesh.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

struct TsdfOptions {
  double voxel_m = 0.1;
  double truncation_voxels = 3.0;  ///< how far before and behind a ray's end cubes are updated
  /// Whether rays also empty the cubes that they pass, which removes what has moved. Only cubes
  /// that some end has touched are updated, so that free space takes no memory.
  bool carve = false;
};

/// A distance field that grows with what is added to it. Takes 4 bytes a cube near a surface, by
/// blocks of 8 x 8 x 8 cubes.
class TsdfVolume {
 public:
  /// Errors: invalid_argument (an option outside its range), unsupported (a build without OpenVDB).
  [[nodiscard]] static Result<TsdfVolume> create(const TsdfOptions& options);
  ~TsdfVolume();
  TsdfVolume(TsdfVolume&& other) noexcept;
  TsdfVolume& operator=(TsdfVolume&& other) noexcept;

  /// Adds rays, in the map's frame. Those that end over 2^19 cubes from its origin are passed over.
  void add(std::span<const Ray> rays);

  /// The surface between cubes that at least `min_weight` rays have updated, or that lie
  /// between two of that kind.
  [[nodiscard]] TriangleMesh surface(int min_weight = 1) const;

  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct Field;
  explicit TsdfVolume(std::unique_ptr<Field> field);
  std::unique_ptr<Field> field_;
};

}  // namespace sweepcast::lab
