// Finds the nearest of many points.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <nanoflann.hpp>
#include <span>

namespace sweepcast::lab {

/// Finds nearest points; the points must outlive the tree. Names of the members with `kdtree_` are
/// nanoflann's.
class PointTree {
 public:
  static constexpr std::size_t kMostNeighbours = 12;  ///< that a query gives

  explicit PointTree(std::span<const Eigen::Vector3d> points) : points_(points), index_(3, *this) {}
  PointTree(const PointTree&) = delete;
  PointTree& operator=(const PointTree&) = delete;

  /// Indices of the nearest points, nearest first; fewer where there are fewer.
  std::span<const std::uint32_t> nearest(const Eigen::Vector3d& query,
                                         std::span<std::uint32_t> indices) const {
    std::array<double, kMostNeighbours> squares{};
    const std::size_t found = index_.knnSearch(
        query.data(), std::min(indices.size(), squares.size()), indices.data(), squares.data());
    return indices.first(found);
  }

  /// Index of the nearest point; there must be one.
  std::uint32_t nearest(const Eigen::Vector3d& query) const {
    std::uint32_t index = 0;
    double square = 0;
    index_.knnSearch(query.data(), 1, &index, &square);
    return index;
  }

  std::size_t kdtree_get_point_count() const { return points_.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points_[i][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }

 private:
  using Metric = nanoflann::L2_Simple_Adaptor<double, PointTree>;

  std::span<const Eigen::Vector3d> points_;
  nanoflann::KDTreeSingleIndexAdaptor<Metric, PointTree, 3, std::uint32_t> index_;
};

}  // namespace sweepcast::lab
