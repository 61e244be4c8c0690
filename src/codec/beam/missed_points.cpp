#include "codec/beam/missed_points.hpp"

#include <algorithm>
#include <cstdlib>

namespace sweepcast::beam {
namespace {

// Points are sought so many rows and columns away: the base of the lattice is not farther apart.
constexpr std::size_t kRows = 4;
constexpr std::size_t kCols = 12;

bool is_point(CellState state) {
  return state == CellState::measured || state == CellState::filled;
}

// Whether any point that the decoder has is as near as that to the point of a cell; its distance by
// range, azimuth and elevation, which small angles make orthogonal.
bool has_near(const ThinnedImage& image, std::size_t row, std::size_t col, std::int32_t reach) {
  constexpr double kTangent = 1.0 / (1 << 24);
  const std::int32_t range = image.truth[row * image.cols + col];
  const double most = static_cast<double>(reach) * reach;
  const std::size_t last_row = std::min(row + kRows, image.elevation.size() - 1);
  const std::size_t last_col = std::min(col + kCols, image.cols - 1);
  for (std::size_t r = row - std::min(row, kRows); r <= last_row; ++r) {
    const double rise = kTangent * (image.elevation[r] - image.elevation[row]);
    for (std::size_t c = col - std::min(col, kCols); c <= last_col; ++c) {
      const std::size_t at = r * image.cols + c;
      const std::int32_t apart = image.decoded[at] - range;
      if (std::abs(apart) > reach || !is_point(image.state[at])) continue;
      const double turn = image.column_angle * (static_cast<double>(c) - static_cast<double>(col));
      const double across =
          static_cast<double>(range) * image.decoded[at] * (turn * turn + rise * rise);
      if (static_cast<double>(apart) * apart + across <= most) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<std::size_t> missed_cells(const ThinnedImage& image, std::int32_t reach) {
  std::vector<std::size_t> missed;
  for (std::size_t row = 0; row < image.elevation.size(); ++row) {
    for (std::size_t col = 0; col < image.cols; ++col) {
      const std::size_t cell = row * image.cols + col;
      if (image.truth[cell] == 0) continue;
      const bool is_there =
          is_point(image.state[cell]) && std::abs(image.decoded[cell] - image.truth[cell]) <= reach;
      if (!is_there && !has_near(image, row, col, reach)) missed.push_back(cell);
    }
  }
  return missed;
}

}  // namespace sweepcast::beam
