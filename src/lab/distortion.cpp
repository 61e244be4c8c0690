#include "lab/distortion.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "lab/point_tree.hpp"

namespace sweepcast::lab {
namespace {

using Eigen::Vector3d;

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

/// The points that can be compared, and how many cannot.
struct Points {
  std::vector<Vector3d> at;
  std::size_t left_out = 0;
};

Points usable(const CloudView& cloud) {
  Points points;
  points.at.reserve(cloud.size);
  for (std::size_t i = 0; i < cloud.size; ++i) {
    const Vector3d p(cloud.x.at(i), cloud.y.at(i), cloud.z.at(i));
    if (p.allFinite() && !p.isZero(0.0)) {
      points.at.push_back(p);
    } else {
      ++points.left_out;
    }
  }
  return points;
}

/// Unit normals by principal component analysis: the direction in which the neighbours of a point
/// vary least. Zero where fewer than three neighbours exist.
std::vector<Vector3d> estimate_normals(std::span<const Vector3d> points, const PointTree& tree) {
  std::vector<Vector3d> normals;
  normals.reserve(points.size());
  std::array<std::uint32_t, kNormalNeighbours> indices{};
  for (const Vector3d& point : points) {
    const auto neighbours = tree.nearest(point, indices);
    // Relative to the point itself: far from the origin, squares would swallow the differences.
    Vector3d mean = Vector3d::Zero();
    for (const std::uint32_t i : neighbours) mean += points[i] - point;
    mean /= static_cast<double>(neighbours.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const std::uint32_t i : neighbours) {
      const Vector3d d = points[i] - point - mean;
      covariance += d * d.transpose();
    }
    const bool defined = neighbours.size() >= 3;
    normals.push_back(defined ? Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance)
                                    .eigenvectors()
                                    .col(0)
                                    .eval()
                              : Vector3d::Zero());
  }
  return normals;
}

/// Squared length of an error along a normal; of the whole error where there is no normal.
double squared_along(const Vector3d& error, const Vector3d& normal) {
  if (normal.isZero(0.0)) return error.squaredNorm();
  const double along = error.dot(normal);
  return along * along;
}

/// What is summed up over the points of one direction.
struct Sums {
  double length = 0, square = 0, square_along = 0, max = 0;
  std::array<std::size_t, kFScoreDistancesM.size()> within{};
  std::size_t count = 0;

  void add(const Vector3d& error, const Vector3d& normal) {
    const double norm = error.norm();
    length += norm;
    square += error.squaredNorm();
    square_along += squared_along(error, normal);
    max = std::max(max, norm);
    for (std::size_t k = 0; k < within.size(); ++k) within[k] += norm <= kFScoreDistancesM[k];
    ++count;
  }

  double mean_of(double sum) const { return sum / static_cast<double>(count); }
  double share_within(std::size_t k) const {
    return static_cast<double>(within[k]) / static_cast<double>(count);
  }
};

double psnr(double mean_square) {
  return 10.0 * std::log10(3.0 * kPeakM * kPeakM / mean_square);
}

double elevation(const Vector3d& p) {
  return std::atan2(p.z(), std::hypot(p.x(), p.y()));
}

/// Azimuth of `to` less that of `from`, within -pi to pi.
double azimuth_between(const Vector3d& from, const Vector3d& to) {
  return std::remainder(std::atan2(to.y(), to.x()) - std::atan2(from.y(), from.x()),
                        2.0 * std::numbers::pi);
}

void set_equal(Distortion& result) {
  result.d1_psnr = result.d2_psnr = std::numeric_limits<double>::infinity();
  result.f_score.fill(100.0);
}

void set_incomparable(Distortion& result) {
  for (double Distortion::*value :
       {&Distortion::mean_o2d, &Distortion::rms_o2d, &Distortion::max_o2d, &Distortion::mean_d2o,
        &Distortion::rms_d2o, &Distortion::max_d2o, &Distortion::d1_psnr, &Distortion::d2_psnr,
        &Distortion::mean_azimuth_error_deg, &Distortion::mean_elevation_error_deg}) {
    result.*value = kNoValue;
  }
}

void set_figures(Distortion& result, const Sums& o2d, const Sums& d2o) {
  result.mean_o2d = o2d.mean_of(o2d.length);
  result.rms_o2d = std::sqrt(o2d.mean_of(o2d.square));
  result.max_o2d = o2d.max;
  result.mean_d2o = d2o.mean_of(d2o.length);
  result.rms_d2o = std::sqrt(d2o.mean_of(d2o.square));
  result.max_d2o = d2o.max;
  result.d1_psnr = psnr(std::max(o2d.mean_of(o2d.square), d2o.mean_of(d2o.square)));
  result.d2_psnr = psnr(std::max(o2d.mean_of(o2d.square_along), d2o.mean_of(d2o.square_along)));
  for (std::size_t k = 0; k < result.f_score.size(); ++k) {
    const double recall = o2d.share_within(k);
    const double precision = d2o.share_within(k);
    const double sum = precision + recall;
    result.f_score[k] = sum > 0 ? 100.0 * 2.0 * precision * recall / sum : 0.0;
  }
}

}  // namespace

struct Reference::State {
  explicit State(const CloudView& original)
      : points(usable(original)),
        tree(points.at),
        normals(estimate_normals(points.at, tree)),
        size(original.size) {}

  Points points;
  PointTree tree;
  std::vector<Vector3d> normals;
  std::size_t size;
};

Reference::Reference(const CloudView& original) : state_(std::make_unique<State>(original)) {}
Reference::Reference(Reference&&) noexcept = default;
Reference& Reference::operator=(Reference&&) noexcept = default;
Reference::~Reference() = default;

Distortion Reference::compare(const CloudView& decoded_cloud) const {
  const auto& original = state_->points.at;
  const Points decoded_points = usable(decoded_cloud);
  const auto& decoded = decoded_points.at;

  Distortion result;
  result.points_original = static_cast<double>(state_->size);
  result.points_decoded = static_cast<double>(decoded_cloud.size);
  result.left_out_original = static_cast<double>(state_->points.left_out);
  result.left_out_decoded = static_cast<double>(decoded_points.left_out);
  if (original.empty() && decoded.empty()) {
    set_equal(result);
    return result;
  }
  if (original.empty() || decoded.empty()) {
    set_incomparable(result);
    return result;
  }

  const PointTree decoded_tree(decoded);
  Sums o2d;
  for (std::size_t i = 0; i < original.size(); ++i) {
    o2d.add(decoded[decoded_tree.nearest(original[i])] - original[i], state_->normals[i]);
  }
  Sums d2o;
  double azimuth_error = 0;
  double elevation_error = 0;
  for (const Vector3d& point : decoded) {
    const std::uint32_t nearest = state_->tree.nearest(point);
    d2o.add(point - original[nearest], state_->normals[nearest]);
    azimuth_error += azimuth_between(original[nearest], point);
    elevation_error += elevation(point) - elevation(original[nearest]);
  }
  set_figures(result, o2d, d2o);
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  result.mean_azimuth_error_deg = kDegrees * d2o.mean_of(azimuth_error);
  result.mean_elevation_error_deg = kDegrees * d2o.mean_of(elevation_error);
  return result;
}

Distortion compare(const CloudView& original, const CloudView& decoded) {
  return Reference(original).compare(decoded);
}

void DistortionMean::add(const Distortion& distortion) {
  for (const DistortionFigure& figure : kDistortionFigures) {
    sum_.*figure.value += distortion.*figure.value;
  }
  for (std::size_t k = 0; k < sum_.f_score.size(); ++k) sum_.f_score[k] += distortion.f_score[k];
  ++count_;
}

Distortion DistortionMean::mean() const {
  Distortion result = sum_;
  if (count_ == 0) return result;
  const auto count = static_cast<double>(count_);
  for (const DistortionFigure& figure : kDistortionFigures) result.*figure.value /= count;
  for (double& f_score : result.f_score) f_score /= count;
  return result;
}

}  // namespace sweepcast::lab
