#include "lab/mesh/mesh_error.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "lab/point_tree.hpp"

namespace sweepcast::lab {

namespace {

constexpr double kFar = 1.0;  // metres; a distance beyond counts as this

double area_of(const TriangleMesh& mesh, std::size_t triangle) {
  const Eigen::Vector3d a = mesh.corner(triangle, 0);
  const Eigen::Vector3d cross = (mesh.corner(triangle, 1) - a).cross(mesh.corner(triangle, 2) - a);
  return 0.5 * cross.norm();
}

// The fractional part of multiples of two irrational numbers covers the unit square evenly
// (Roberts, The unreasonable effectiveness of quasirandom sequences, 2018); folded to a triangle.
Eigen::Vector2d place_in_triangle(double index) {
  constexpr double kPlastic = 1.32471795724474602596;
  double u = index / kPlastic;
  double v = index / (kPlastic * kPlastic);
  u -= std::floor(u);
  v -= std::floor(v);
  if (u + v > 1.0) return {1.0 - u, 1.0 - v};
  return {u, v};
}

double distance_to_segment(const Eigen::Vector3d& point, const Eigen::Vector3d& a,
                           const Eigen::Vector3d& b) {
  const Eigen::Vector3d side = b - a;
  const double square = side.squaredNorm();
  const double share = square > 0.0 ? std::clamp((point - a).dot(side) / square, 0.0, 1.0) : 0.0;
  return (point - a - share * side).norm();
}

/// Finds how far points are from a mesh, by way of the samples nearest to them.
class NearestSurface {
 public:
  NearestSurface(const TriangleMesh& mesh, const std::vector<SurfaceSample>& samples)
      : mesh_(mesh), samples_(samples), places_(places_of(samples)), tree_(places_) {}

  double distance(const Eigen::Vector3d& point) const {
    std::array<std::uint32_t, 6> indices{};
    double best = kFar;
    for (const std::uint32_t index : tree_.nearest(point, indices)) {
      const std::size_t triangle = samples_[index].triangle;
      best = std::min(
          best, distance_to_triangle(point, mesh_.corner(triangle, 0), mesh_.corner(triangle, 1),
                                     mesh_.corner(triangle, 2)));
    }
    return best;
  }

 private:
  static std::vector<Eigen::Vector3d> places_of(const std::vector<SurfaceSample>& samples) {
    std::vector<Eigen::Vector3d> places;
    places.reserve(samples.size());
    for (const SurfaceSample& sample : samples) places.push_back(sample.place);
    return places;
  }

  const TriangleMesh& mesh_;
  const std::vector<SurfaceSample>& samples_;
  std::vector<Eigen::Vector3d> places_;
  PointTree tree_;
};

/// Distances, counted as they come.
struct DistanceCount {
  explicit DistanceCount(std::span<const double> limits)
      : thresholds(limits), within(limits.size()) {}

  void add(double distance) {
    sum += distance;
    ++count;
    for (std::size_t i = 0; i < thresholds.size(); ++i) {
      if (distance <= thresholds[i]) ++within[i];
    }
  }
  [[nodiscard]] double mean() const { return sum / static_cast<double>(count); }
  [[nodiscard]] double percent(std::size_t threshold) const {
    return 100.0 * static_cast<double>(within[threshold]) / static_cast<double>(count);
  }

  std::span<const double> thresholds;
  std::vector<std::size_t> within;
  double sum = 0.0;
  std::size_t count = 0;
};

std::vector<SurfaceSample> sample_capped(const TriangleMesh& mesh,
                                         const MeshErrorOptions& options) {
  const double most = static_cast<double>(options.max_samples) / surface_area(mesh);
  return sample_surface(mesh, std::min(options.samples_per_m2, most));
}

}  // namespace

double surface_area(const TriangleMesh& mesh) {
  double area = 0.0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) area += area_of(mesh, i);
  return area;
}

std::vector<SurfaceSample> sample_surface(const TriangleMesh& mesh, double per_m2) {
  std::vector<SurfaceSample> samples;
  double due = 0.5;  // samples that the area so far should have, halfway between two
  double next = 1.0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    due += per_m2 * area_of(mesh, i);
    for (; next <= due; next += 1.0) {
      const Eigen::Vector2d share = place_in_triangle(next);
      const Eigen::Vector3d a = mesh.corner(i, 0);
      samples.push_back(
          {a + share.x() * (mesh.corner(i, 1) - a) + share.y() * (mesh.corner(i, 2) - a),
           static_cast<std::uint32_t>(i)});
    }
  }
  return samples;
}

double distance_to_triangle(const Eigen::Vector3d& point, const Eigen::Vector3d& a,
                            const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double square = normal.squaredNorm();
  if (square > 0.0) {  // above the triangle's inside, if it is on the same side of all edges
    const Eigen::Vector3d offset = point - a;
    const double v = (b - a).cross(offset).dot(normal);
    const double u = offset.cross(c - a).dot(normal);
    if (u >= 0.0 && v >= 0.0 && u + v <= square) {
      return std::abs(offset.dot(normal)) / std::sqrt(square);
    }
  }
  return std::min({distance_to_segment(point, a, b), distance_to_segment(point, b, c),
                   distance_to_segment(point, c, a)});
}

Result<MeshError> mesh_error(const TriangleMesh& estimate, const TriangleMesh& truth,
                             const MeshErrorOptions& options,
                             const std::function<bool(const Eigen::Vector3d&)>& counts) {
  const std::vector<SurfaceSample> found = sample_capped(estimate, options);
  const std::vector<SurfaceSample> wanted = sample_capped(truth, options);
  if (found.empty() || wanted.empty()) {
    return fail(ErrorCode::invalid_argument,
                "a mesh without surface cannot be compared; give finer voxels or more sweeps");
  }
  DistanceCount to_truth(options.thresholds_m), to_estimate(options.thresholds_m);
  {
    const NearestSurface surface(truth, wanted);
    for (const SurfaceSample& sample : found) to_truth.add(surface.distance(sample.place));
  }
  const NearestSurface surface(estimate, found);
  for (const SurfaceSample& sample : wanted) {
    if (!counts || counts(sample.place)) to_estimate.add(surface.distance(sample.place));
  }
  if (to_estimate.count == 0) {
    return fail(ErrorCode::invalid_argument,
                "nothing of the true mesh was seen; give the mesh and the poses of this drive");
  }
  MeshError error;
  error.accuracy_m = to_truth.mean();
  error.completeness_m = to_estimate.mean();
  for (std::size_t i = 0; i < options.thresholds_m.size(); ++i) {
    MeshScore score{options.thresholds_m[i], to_truth.percent(i), to_estimate.percent(i), 0.0};
    const double sum = score.precision + score.recall;
    if (sum > 0.0) score.f_score = 2.0 * score.precision * score.recall / sum;
    error.scores.push_back(score);
  }
  return error;
}

}  // namespace sweepcast::lab
