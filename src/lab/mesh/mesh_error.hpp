// How far one surface lies from another.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "lab/mesh/triangle_mesh.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// A place on a mesh.
struct SurfaceSample {
  Eigen::Vector3d place;
  std::uint32_t triangle = 0;
};

/// Places spread evenly over a mesh's area, `per_m2` on each square metre; the same for the same
/// mesh. Triangles take part by their area alone, however they are cut.
[[nodiscard]] std::vector<SurfaceSample> sample_surface(const TriangleMesh& mesh, double per_m2);

[[nodiscard]] double surface_area(const TriangleMesh& mesh);  ///< square metres

/// The distance from a point to a triangle.
[[nodiscard]] double distance_to_triangle(const Eigen::Vector3d& point, const Eigen::Vector3d& a,
                                          const Eigen::Vector3d& b, const Eigen::Vector3d& c);

struct MeshErrorOptions {
  std::vector<double> thresholds_m = {0.05, 0.1, 0.2};
  double samples_per_m2 = 100.0;
  std::size_t max_samples = 4'000'000;  ///< on a mesh; fewer a square metre where it is large
};

/// Shares of surface that lies within a distance of the other's, per cent.
struct MeshScore {
  double threshold_m = 0.0;
  double precision = 0.0;  ///< of the estimate
  double recall = 0.0;     ///< of the part of the truth that counts
  double f_score = 0.0;    ///< their harmonic mean
};

struct MeshError {
  double accuracy_m = 0.0;      ///< mean distance from the estimate to the truth
  double completeness_m = 0.0;  ///< mean distance from what counts of the truth to the estimate
  std::vector<MeshScore> scores;
};

/// Compares by samples of both, each with the nearest triangles of the other. Distances over 1 m
/// count as 1 m in the means. `counts` says which places of the truth should be in the estimate
/// (all where it is empty); the estimate is compared with the whole truth.
/// Errors: invalid_argument (a mesh without area, or no part of the truth counts).
[[nodiscard]] Result<MeshError> mesh_error(
    const TriangleMesh& estimate, const TriangleMesh& truth, const MeshErrorOptions& options = {},
    const std::function<bool(const Eigen::Vector3d&)>& counts = {});

}  // namespace sweepcast::lab
