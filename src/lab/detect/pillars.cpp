#include "lab/detect/pillars.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace sweepcast::lab {

namespace {

using Grid = PillarGrid;

// The cell of a point; -1 outside the grid. Comparisons are such that NaN is outside.
std::int64_t cell_of(float x, float y, float z) {
  const bool inside = std::abs(x) < Grid::kReach && std::abs(y) < Grid::kReach &&
                      z > Grid::kLowest && z < Grid::kHighest;
  if (!inside) return -1;
  const auto index = [](float at) {
    const int i = static_cast<int>((at + Grid::kReach) / Grid::kSize);
    return std::clamp(i, 0, Grid::kSide - 1);
  };
  return static_cast<std::int64_t>(index(y)) * Grid::kSide + index(x);
}

float middle_of(std::int64_t index) {
  return (static_cast<float>(index) + 0.5F) * Grid::kSize - Grid::kReach;
}

struct Placed {
  std::int64_t cell;
  std::size_t point;
};

}  // namespace

Pillars make_pillars(std::span<const float> x, std::span<const float> y, std::span<const float> z) {
  std::vector<Placed> placed;
  placed.reserve(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::int64_t cell = cell_of(x[i], y[i], z[i]);
    if (cell >= 0) placed.push_back({cell, i});
  }
  std::sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) {
    return std::pair(a.cell, a.point) < std::pair(b.cell, b.point);
  });
  Pillars pillars;
  for (std::size_t begin = 0; begin < placed.size();) {
    std::size_t end = begin;
    while (end < placed.size() && placed[end].cell == placed[begin].cell) ++end;
    const std::size_t stride = (end - begin + Grid::kMostPoints - 1) / Grid::kMostPoints;
    std::array<float, 3> mean{};
    float count = 0.0F;
    for (std::size_t i = begin; i < end; i += stride, ++count) {
      const std::size_t p = placed[i].point;
      mean[0] += x[p];
      mean[1] += y[p];
      mean[2] += z[p];
    }
    for (float& coordinate : mean) coordinate /= count;
    const std::int64_t cell = placed[begin].cell;
    const float middle_x = middle_of(cell % Grid::kSide);
    const float middle_y = middle_of(cell / Grid::kSide);
    const auto owner = static_cast<std::int64_t>(pillars.cell.size());
    for (std::size_t i = begin; i < end; i += stride) {
      const std::size_t p = placed[i].point;
      pillars.owner.push_back(owner);
      pillars.features.insert(
          pillars.features.end(),
          {x[p] / Grid::kReach, y[p] / Grid::kReach, z[p] / 2.0F, (x[p] - mean[0]) / Grid::kSize,
           (y[p] - mean[1]) / Grid::kSize, z[p] - mean[2], (x[p] - middle_x) / Grid::kSize,
           (y[p] - middle_y) / Grid::kSize});
    }
    pillars.cell.push_back(cell);
    begin = end;
  }
  return pillars;
}

}  // namespace sweepcast::lab
