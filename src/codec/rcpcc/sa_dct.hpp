// The shape-adaptive DCT of Sikora and Makai for regions of any shape (the paper's III.B.3):
// columns are shifted up and transformed, then rows shifted left and transformed. Orthonormal, with
// the mean taken out first (Kauff and Schueuer's delta-DC correction): without it a region of
// constant range would leave energy in every row, since its columns differ in length.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace sweepcast::rcpcc {

inline constexpr int kLargestRegion = 32;

/// A region of cells: `size` x `size` values at most, those inside the shape.
/// `rows[c]` is a bit mask of the rows that column c has.
struct RegionShape {
  int size = 0;
  std::array<std::uint32_t, kLargestRegion> rows{};
};

/// Values of a region's cells, or its coefficients; at [row][column]. Where a shape has no cell,
/// the value is neither read nor written.
using RegionValues = std::array<std::array<float, kLargestRegion>, kLargestRegion>;

/// The transform; holds the cosine tables of all lengths.
class ShapeAdaptiveDct {
 public:
  ShapeAdaptiveDct();

  /// Replaces values by coefficients; afterwards row p has its coefficients in columns 0 to
  /// `lengths[p]` - 1, the lowest frequency first.
  void forward(const RegionShape& shape, RegionValues& values) const;

  /// Replaces coefficients by values.
  void inverse(const RegionShape& shape, RegionValues& values) const;

  /// How many coefficients each row has: the number of columns with more than p cells.
  [[nodiscard]] static std::array<int, kLargestRegion> row_lengths(const RegionShape& shape);

 private:
  [[nodiscard]] const float* basis(int length) const {
    return basis_.data() + offset_[static_cast<std::size_t>(length)];
  }
  void transform(int length, const float* in, float* out) const;
  void transform_back(int length, const float* in, float* out) const;

  std::vector<float> basis_;  ///< for each length L an L x L matrix, row p the p-th cosine
  std::array<std::size_t, kLargestRegion + 1> offset_{};
};

}  // namespace sweepcast::rcpcc
