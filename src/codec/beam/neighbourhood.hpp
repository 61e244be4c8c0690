// The range image while it is coded, and the neighbours that predictions and contexts look at.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sweepcast::beam {

/// Ranges in 0.1 mm with a margin of empty cells all around, so that neighbours need no checks.
class PaddedImage {
 public:
  struct Cell {
    std::int32_t range = 0;     ///< reconstructed; 0 where empty or not yet known
    std::uint32_t inverse = 0;  ///< 2^44 / range
    std::uint8_t state = 0;     ///< 0 not yet known, 1 empty, 2 holds a point
    std::uint8_t activity = 0;  ///< how far the prediction was off, in steps, at most 20
  };

  /// All cells unknown. Neighbours are looked at as far as three of the largest strides away.
  void reset(int rows, int cols, int row_stride, int col_stride) {
    rows_ = rows;
    cols_ = cols;
    row_margin_ = 3 * row_stride;
    col_margin_ = 3 * col_stride;
    pitch_ = cols + 2 * col_margin_;
    cells_.assign(cells(rows, cols, row_stride, col_stride), Cell{});
  }
  /// How many cells such an image has, margin included.
  [[nodiscard]] static std::size_t cells(int rows, int cols, int row_stride, int col_stride) {
    return static_cast<std::size_t>(cols + 6 * col_stride) *
           static_cast<std::size_t>(rows + 6 * row_stride);
  }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int cols() const { return cols_; }
  [[nodiscard]] std::ptrdiff_t pitch() const { return pitch_; }
  [[nodiscard]] Cell* at(int row, int col) {
    return cells_.data() + static_cast<std::ptrdiff_t>(row + row_margin_) * pitch_ + col +
           col_margin_;
  }

 private:
  int rows_ = 0, cols_ = 0;
  int row_margin_ = 0, col_margin_ = 0;
  int pitch_ = 0;
  std::vector<Cell> cells_;
};

/// Where a cell's neighbours are, as distances in cells from it.
struct Neighbourhood {
  std::ptrdiff_t along;   ///< to the next known cell on the axis that the step halves
  std::ptrdiff_t across;  ///< to the next known cell on the other axis
  std::uint32_t
      weight;  ///< of the neighbour at -along in interpolation, 1/65536; the other has the rest
  std::uint32_t step;  ///< number of the step in the lattice, for contexts
};

inline constexpr std::int32_t kNearest = 2'000;        ///< 0.2 m
inline constexpr std::int32_t kFarthest = 10'000'000;  ///< 1 km
inline constexpr std::uint64_t kInverseOne = std::uint64_t{1} << 44;

[[nodiscard]] inline std::uint32_t inverse_of(std::int32_t range) {
  const std::uint64_t inverse = kInverseOne / static_cast<std::uint64_t>(range);
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(inverse, 0xFFFFFFFFU));
}

/// The cells around one. On the axis that the step halves: a before and b after it, aa and bb
/// beyond these, aaa and bbb beyond those. On the other axis: n, which is done, nn and nnn beyond
/// it, and the corners na, nb, nna, nnb on that side, sa, sb on the other, where coarser steps
/// reached.
struct View {
  using Cell = PaddedImage::Cell;
  const Cell *a, *b, *n, *na, *nb, *sa, *sb, *aa, *bb, *nn;
  const Cell *aaa, *bbb, *nnn, *nna, *nnb;

  View(const Cell* c, const Neighbourhood& at)
      : a(c - at.along),
        b(c + at.along),
        n(c - at.across),
        na(n - at.along),
        nb(n + at.along),
        sa(c + at.across - at.along),
        sb(c + at.across + at.along),
        aa(a - at.along),
        bb(b + at.along),
        nn(n - at.across),
        aaa(aa - at.along),
        bbb(bb + at.along),
        nnn(nn - at.across),
        nna(nn - at.along),
        nnb(nn + at.along) {}
};

[[nodiscard]] inline std::uint64_t interpolate(std::uint32_t a, std::uint32_t b,
                                               std::uint32_t weight) {
  return (std::uint64_t{a} * weight + std::uint64_t{b} * (65'536U - weight)) >> 16;
}
[[nodiscard]] inline std::int32_t range_of(std::uint64_t inverse) {
  return static_cast<std::int32_t>(std::clamp<std::uint64_t>(
      kInverseOne / std::max<std::uint64_t>(inverse, 1), kNearest, kFarthest));
}
// Four times the logarithm to base 2, with the fraction taken as linear.
[[nodiscard]] inline std::uint32_t log2_quarters(std::uint32_t value) {
  if (value < 4) return 0;
  std::uint32_t exponent = 0;
  for (std::uint32_t v = value; v >= 8; v >>= 1) ++exponent;
  return exponent * 4U + ((value >> exponent) & 3U);
}

}  // namespace sweepcast::beam
