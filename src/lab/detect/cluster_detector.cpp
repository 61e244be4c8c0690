// A detector without weights: ground away, clusters on a grid, an L-shape, a car's size.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "lab/detect/anchors.hpp"
#include "lab/detect/detector.hpp"
#include "lab/detect/l_shape.hpp"

namespace sweepcast::lab {

namespace {

constexpr double kReach = 60.0;  // metres, of what is looked at
constexpr double kNone = 1e9;    // where nothing was measured
constexpr double kLowest = 0.3;  // metres above the ground that a car's points have
constexpr double kHighest = 2.6;
constexpr double kLength = 4.3, kWidth = 1.75;  // of a usual car

// Square cells about the sensor.
class Cells {
 public:
  explicit Cells(double size) : size_(size), side_(static_cast<int>(2.0 * kReach / size)) {}

  [[nodiscard]] int side() const { return side_; }
  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
  }
  [[nodiscard]] std::size_t at(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(side_) +
           static_cast<std::size_t>(column);
  }
  /// The cell of a point, which must be within reach.
  [[nodiscard]] std::size_t of(const Eigen::Vector3d& p) const {
    return at(index(p.y()), index(p.x()));
  }
  /// Calls `visit(cell)` for the cells of the square about a cell.
  template <class Visit>
  void around(std::size_t cell, int span, const Visit& visit) const {
    const int row = static_cast<int>(cell) / side_, column = static_cast<int>(cell) % side_;
    for (int r = std::max(0, row - span); r <= std::min(side_ - 1, row + span); ++r) {
      for (int c = std::max(0, column - span); c <= std::min(side_ - 1, column + span); ++c) {
        visit(at(r, c));
      }
    }
  }

 private:
  [[nodiscard]] int index(double at) const {
    return std::clamp(static_cast<int>((at + kReach) / size_), 0, side_ - 1);
  }
  double size_;
  int side_;
};

// A point with its height above the ground.
struct Raised {
  Eigen::Vector3d place;
  double height;
};

std::vector<Eigen::Vector3d> points_in_reach(const PointCloud& cloud) {
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d p(static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]),
                            static_cast<double>(cloud.z[i]));
    if (std::abs(p.x()) < kReach && std::abs(p.y()) < kReach && std::abs(p.z()) < kReach) {
      points.push_back(p);
    }
  }
  return points;
}

// What stands on the ground, which is the lowest point within about 2 m.
std::vector<Raised> above_ground(const std::vector<Eigen::Vector3d>& points) {
  constexpr double kCell = 0.8;
  constexpr int kSpan = 2;
  const Cells cells(kCell);
  std::vector<double> lowest(cells.count(), kNone);
  for (const auto& p : points) {
    double& z = lowest[cells.of(p)];
    z = std::min(z, p.z());
  }
  std::vector<double> ground(cells.count(), kNone);
  for (std::size_t cell = 0; cell < cells.count(); ++cell) {
    if (lowest[cell] == kNone) continue;
    cells.around(cell, kSpan,
                 [&](std::size_t near) { ground[cell] = std::min(ground[cell], lowest[near]); });
  }
  std::vector<Raised> raised;
  for (const auto& p : points) {
    const double height = p.z() - ground[cells.of(p)];
    // Trees reach over cars: what is far above does not join clusters.
    if (height >= kLowest && height <= kHighest + 0.3) raised.push_back({p, height});
  }
  return raised;
}

// Points whose cells touch, or are one cell apart, belong together.
std::vector<std::vector<Raised>> cluster(const std::vector<Raised>& points) {
  constexpr double kCell = 0.2;
  constexpr int kSpan = 2;
  const Cells cells(kCell);
  std::vector<std::vector<std::size_t>> members(cells.count());
  for (std::size_t i = 0; i < points.size(); ++i) members[cells.of(points[i].place)].push_back(i);
  std::vector<std::vector<Raised>> clusters;
  std::vector<std::size_t> open;
  for (std::size_t first = 0; first < members.size(); ++first) {
    if (members[first].empty()) continue;
    clusters.emplace_back();
    open.assign(1, first);
    while (!open.empty()) {
      const std::size_t cell = open.back();
      open.pop_back();
      for (const std::size_t i : std::exchange(members[cell], {})) {
        clusters.back().push_back(points[i]);
      }
      cells.around(cell, kSpan, [&](std::size_t near) {
        if (!members[near].empty()) open.push_back(near);
      });
    }
  }
  return clusters;
}

// Makes an extent `wanted` long, away from the sensor, whose side is seen.
void grow(Eigen::Vector2d& centre, double& extent, double yaw, double wanted) {
  if (extent >= wanted) return;
  const Eigen::Vector2d direction(std::cos(yaw), std::sin(yaw));
  const double away = centre.dot(direction) >= 0.0 ? 0.5 : -0.5;
  centre += away * (wanted - extent) * direction;
  extent = wanted;
}

// A rectangle as a car of at least the usual size. Where no side is as long as a car is wide, the
// rear or the front was seen.
Box as_car(Rectangle seen) {
  constexpr double kWidest = 2.3;
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  const double longer = std::max(seen.along, seen.across);
  bool lengthwise = seen.along >= seen.across;
  if (longer <= kWidest) lengthwise = !lengthwise;  // what is seen is the width
  Box box;
  box.yaw = lengthwise ? seen.yaw : seen.yaw + kQuarter;
  box.length = lengthwise ? seen.along : seen.across;
  box.width = lengthwise ? seen.across : seen.along;
  grow(seen.centre, box.length, box.yaw, kLength);
  grow(seen.centre, box.width, box.yaw + kQuarter, kWidth);
  box.centre.head<2>() = seen.centre;
  return box;
}

std::optional<Box> box_of(const std::vector<Raised>& points) {
  constexpr std::size_t kLeastPoints = 8;
  constexpr double kLeastTop = 0.7, kLeastSide = 1.0;
  constexpr double kLongest = 6.0, kWidest = 2.6;
  if (points.size() < kLeastPoints) return {};
  std::vector<Eigen::Vector2d> outline;
  double top = 0.0, ground = 0.0;
  for (const Raised& p : points) {
    outline.emplace_back(p.place.head<2>());
    top = std::max(top, p.height);
    ground += (p.place.z() - p.height) / static_cast<double>(points.size());
  }
  if (top < kLeastTop || top > kHighest) return {};
  const Rectangle seen = fit_l_shape(outline);
  const double longer = std::max(seen.along, seen.across);
  const double shorter = std::min(seen.along, seen.across);
  if (longer < kLeastSide || longer > kLongest || shorter > kWidest) return {};
  Box box = as_car(seen);
  box.height = std::max(top, 1.4);
  box.centre.z() = ground + 0.5 * box.height;
  // The more of a car was seen, and the better its size fits, the surer.
  const auto count = static_cast<double>(points.size());
  const double misfit =
      std::abs(box.length - kLength) + std::abs(box.width - kWidth) + std::abs(box.height - 1.5);
  const double share = std::min(1.0, longer / kLength);
  box.score = share * count / (count + 30.0) * std::exp(-misfit);
  return box;
}

class ClusterDetector : public Detector {
 public:
  Result<std::vector<Box>> detect(const PointCloud& cloud) override {
    std::vector<Box> boxes;
    for (const auto& points : cluster(above_ground(points_in_reach(cloud)))) {
      if (auto box = box_of(points)) boxes.push_back(std::move(*box));
    }
    boxes = suppress_overlaps(std::move(boxes), 0.1);
    count_points(cloud, boxes);
    return boxes;
  }
};

}  // namespace

Result<std::unique_ptr<Detector>> make_cluster_detector() {
  return std::make_unique<ClusterDetector>();
}

}  // namespace sweepcast::lab
