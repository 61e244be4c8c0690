// Finds the nearest of many points.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <nanoflann.hpp>
#include <numeric>
#include <span>
#include <tuple>
#include <vector>

namespace sweepcast::lab {

/// Finds nearest points; the points must outlive the tree, and be finite. Names of the members with
/// `kdtree_` are nanoflann's.
///
/// Equal points are one place in the tree, or a query at a place with very many of them would visit
/// them all. A query gives each of them all the same, under the index of the first.
class PointTree {
 public:
  static constexpr std::size_t kMostNeighbours = 12;  ///< that a query gives

  explicit PointTree(std::span<const Eigen::Vector3d> points)
      : points_(points), places_(distinct(points)), index_(3, *this) {}
  PointTree(const PointTree&) = delete;
  PointTree& operator=(const PointTree&) = delete;

  /// Indices of the nearest points, nearest first; fewer where there are fewer.
  std::span<const std::uint32_t> nearest(const Eigen::Vector3d& query,
                                         std::span<std::uint32_t> indices) const {
    const std::size_t wanted = std::min(indices.size(), kMostNeighbours);
    std::array<double, kMostNeighbours> squares{};
    std::array<std::uint32_t, kMostNeighbours> found{};
    const std::size_t places = index_.knnSearch(query.data(), wanted, found.data(), squares.data());
    std::size_t count = 0;
    for (std::size_t i = 0; i < places; ++i) {
      const Place& place = places_[found[i]];
      for (std::uint32_t k = 0; k < place.points && count < wanted; ++k) {
        indices[count++] = place.first;
      }
    }
    return indices.first(count);
  }

  /// Index of the nearest point; there must be one.
  std::uint32_t nearest(const Eigen::Vector3d& query) const {
    std::uint32_t place = 0;
    double square = 0;
    index_.knnSearch(query.data(), 1, &place, &square);
    return places_[place].first;
  }

  /// Places, at each of which there are one or more points.
  std::size_t kdtree_get_point_count() const { return places_.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points_[places_[i].first][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }

 private:
  using Metric = nanoflann::L2_Simple_Adaptor<double, PointTree>;

  /// Equal points.
  struct Place {
    std::uint32_t first = 0;   ///< index of one of them, the lowest
    std::uint32_t points = 0;  ///< how many they are
  };

  /// The places, by their first point.
  static std::vector<Place> distinct(std::span<const Eigen::Vector3d> points) {
    const auto key = [&](std::uint32_t i) {
      return std::tuple(points[i].x(), points[i].y(), points[i].z());
    };
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), std::uint32_t{0});
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tuple_cat(key(a), std::tuple(a)) < std::tuple_cat(key(b), std::tuple(b));
    });
    std::vector<Place> places;
    for (const std::uint32_t i : order) {
      if (places.empty() || key(places.back().first) != key(i)) places.push_back({i, 0});
      ++places.back().points;
    }
    std::sort(places.begin(), places.end(),
              [](const Place& a, const Place& b) { return a.first < b.first; });
    return places;
  }

  std::span<const Eigen::Vector3d> points_;
  std::vector<Place> places_;
  nanoflann::KDTreeSingleIndexAdaptor<Metric, PointTree, 3, std::uint32_t> index_;
};

}  // namespace sweepcast::lab
