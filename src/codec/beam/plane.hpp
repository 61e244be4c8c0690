// A range image while it is coded: what is known of its cells, one plane a quantity, with a margin
// of unknown cells all around, so that neighbours need no checks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sweepcast::beam {

/// What is known of a cell.
enum class CellState : std::uint8_t {
  unknown,      ///< not yet coded
  empty,        ///< no point
  measured,     ///< holds a point
  filled,       ///< left out at the encoder's wish: the range is what interpolation gives
  assumed = 6,  ///< left out beside a jump in depth: a range for the neighbours' sake, no point
};

inline constexpr std::int32_t kNearest = 2'000;        ///< shortest range, 0.1 mm: 0.2 m
inline constexpr std::int32_t kFarthest = 10'000'000;  ///< longest: 1 km

/// How far predictions were off at a cell without a range: in doubt.
inline constexpr std::uint8_t kUnknownActivity = 10;

/// Rows and columns of cells.
class Plane {
 public:
  /// All cells unknown. Neighbours may be looked at kMargin columns and `row_margin` rows outside.
  void reset(int rows, int cols, int row_margin);

  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int cols() const { return cols_; }
  [[nodiscard]] std::ptrdiff_t pitch() const { return pitch_; }

  /// Index of a cell in the three planes below; neighbours are at +-1 and +-pitch().
  [[nodiscard]] std::ptrdiff_t at(int row, int col) const {
    return static_cast<std::ptrdiff_t>(row + row_margin_) * pitch_ + col + kMargin;
  }

  std::vector<std::int32_t> range;     ///< decoded, 0.1 mm; 0 where empty or unknown
  std::vector<std::uint8_t> activity;  ///< by how many steps predictions were off, at most 20
  std::vector<CellState> state;

  static constexpr int kMargin = 16;

 private:
  int rows_ = 0, cols_ = 0;
  int row_margin_ = 0;
  std::ptrdiff_t pitch_ = 0;
};

/// Puts the columns of `odd` between those of `even`: column 2 i of `out` is column i of `even`,
/// column 2 i + 1 column i of `odd`, which has as many or one less.
void interleave(const Plane& even, const Plane& odd, Plane& out);

}  // namespace sweepcast::beam
