#include "codec/rcpcc/sa_dct.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "core/random.hpp"

namespace sweepcast::rcpcc {
namespace {

using test::uniform;
using test::uniform_int;

using Matrix = std::vector<std::vector<double>>;

bool has(const RegionShape& shape, int row, int col) {
  return ((shape.rows[static_cast<std::size_t>(col)] >> row) & 1U) != 0;
}

float& at(RegionValues& values, int row, int col) {
  return values[static_cast<std::size_t>(row)][static_cast<std::size_t>(col)];
}

RegionShape random_shape(std::mt19937& random, int size) {
  RegionShape shape;
  shape.size = size;
  const double density = uniform(random, 0.05, 1.0);
  for (int col = 0; col < size; ++col) {
    for (int row = 0; row < size; ++row) {
      if (uniform(random, 0, 1) < density) {
        shape.rows[static_cast<std::size_t>(col)] |= std::uint32_t{1} << row;
      }
    }
  }
  return shape;
}

RegionShape full_shape(int size) {
  RegionShape shape;
  shape.size = size;
  const std::uint32_t all = size == 32 ? ~0U : (1U << size) - 1;
  std::fill_n(shape.rows.begin(), size, all);
  return shape;
}

RegionValues random_values(std::mt19937& random) {
  RegionValues values;
  for (auto& row : values) {
    for (float& value : row) value = static_cast<float>(uniform(random, -5000, 5000));
  }
  return values;
}

/// The orthonormal DCT-II of a vector by its definition.
std::vector<double> dct(const std::vector<double>& in) {
  const auto n = static_cast<double>(in.size());
  std::vector<double> out(in.size());
  for (std::size_t p = 0; p < in.size(); ++p) {
    for (std::size_t k = 0; k < in.size(); ++k) {
      out[p] += in[k] * std::cos(std::numbers::pi * static_cast<double>(p) *
                                 (static_cast<double>(k) + 0.5) / n);
    }
    out[p] *= std::sqrt((p == 0 ? 1.0 : 2.0) / n);
  }
  return out;
}

/// Row p of the result has the coefficients of row p after both passes.
Matrix naive_forward(const RegionShape& shape, RegionValues& values) {
  Matrix rows(static_cast<std::size_t>(kLargestRegion));
  for (int col = 0; col < shape.size; ++col) {
    std::vector<double> column;
    for (int row = 0; row < shape.size; ++row) {
      if (has(shape, row, col)) column.push_back(double{at(values, row, col)});
    }
    const auto coefficients = dct(column);
    for (std::size_t p = 0; p < coefficients.size(); ++p) rows[p].push_back(coefficients[p]);
  }
  for (auto& row : rows) row = dct(row);
  return rows;
}

TEST(ShapeAdaptiveDct, AgreesWithItsDefinition) {
  std::mt19937 random(1);
  const ShapeAdaptiveDct transform;
  for (int size = 1; size <= kLargestRegion; ++size) {
    for (int round = 0; round < 4; ++round) {
      const RegionShape shape = round == 0 ? full_shape(size) : random_shape(random, size);
      RegionValues values = random_values(random);
      const Matrix expected = naive_forward(shape, values);
      transform.forward(shape, values);
      const auto lengths = ShapeAdaptiveDct::row_lengths(shape);
      for (std::size_t p = 0; p < expected.size(); ++p) {
        ASSERT_EQ(static_cast<std::size_t>(lengths[p]), expected[p].size());
        for (std::size_t q = 0; q < expected[p].size(); ++q) {
          // Sums of up to 1024 terms of up to 5000 in float.
          ASSERT_NEAR(values[p][q], expected[p][q], 0.05) << size << ": " << p << ", " << q;
        }
      }
    }
  }
}

TEST(ShapeAdaptiveDct, InverseUndoesForward) {
  std::mt19937 random(2);
  const ShapeAdaptiveDct transform;
  for (int size = 1; size <= kLargestRegion; ++size) {
    for (int round = 0; round < 20; ++round) {
      const RegionShape shape = random_shape(random, size);
      RegionValues values = random_values(random);
      for (auto& row : values) {
        for (float& value : row) value *= 0.002F;  // metres
      }
      const RegionValues original = values;
      transform.forward(shape, values);
      transform.inverse(shape, values);
      for (int row = 0; row < size; ++row) {
        for (int col = 0; col < size; ++col) {
          if (!has(shape, row, col)) continue;
          ASSERT_NEAR(at(values, row, col),
                      original[static_cast<std::size_t>(row)][static_cast<std::size_t>(col)], 1e-3);
        }
      }
    }
  }
}

TEST(ShapeAdaptiveDct, KeepsTheEnergy) {
  std::mt19937 random(3);
  const ShapeAdaptiveDct transform;
  for (int round = 0; round < 200; ++round) {
    const int size = uniform_int(random, 1, kLargestRegion);
    const RegionShape shape = random_shape(random, size);
    RegionValues values = random_values(random);
    double before = 0;
    for (int row = 0; row < size; ++row) {
      for (int col = 0; col < size; ++col) {
        if (has(shape, row, col)) before += std::pow(double{at(values, row, col)}, 2);
      }
    }
    transform.forward(shape, values);
    const auto lengths = ShapeAdaptiveDct::row_lengths(shape);
    double after = 0;
    for (int p = 0; p < size; ++p) {
      for (int q = 0; q < lengths[static_cast<std::size_t>(p)]; ++q) {
        after += std::pow(double{at(values, p, q)}, 2);
      }
    }
    ASSERT_NEAR(after, before, 1e-5 * before);
  }
}

TEST(ShapeAdaptiveDct, LeavesTheOutsideAlone) {
  std::mt19937 random(4);
  const ShapeAdaptiveDct transform;
  const RegionShape shape = random_shape(random, 8);
  RegionValues a = random_values(random);
  RegionValues b = a;
  for (int row = 0; row < kLargestRegion; ++row) {
    for (int col = 0; col < kLargestRegion; ++col) {
      if (row >= 8 || col >= 8 || !has(shape, row, col)) at(b, row, col) = 1e30F;
    }
  }
  transform.forward(shape, a);
  transform.forward(shape, b);
  const auto lengths = ShapeAdaptiveDct::row_lengths(shape);
  for (int p = 0; p < 8; ++p) {
    for (int q = 0; q < lengths[static_cast<std::size_t>(p)]; ++q) {
      EXPECT_EQ(at(a, p, q), at(b, p, q));
    }
  }
}

TEST(ShapeAdaptiveDct, PutsAConstantSquareIntoOneCoefficient) {
  const ShapeAdaptiveDct transform;
  RegionValues values;
  for (auto& row : values) row.fill(3.0F);
  transform.forward(full_shape(4), values);
  EXPECT_NEAR(values[0][0], 12.0F, 1e-5);  // 3 * sqrt(16)
  EXPECT_NEAR(values[0][1], 0.0F, 1e-5);
  EXPECT_NEAR(values[1][0], 0.0F, 1e-5);
}

TEST(ShapeAdaptiveDct, RowLengthsCountTheColumnsWithMoreCells) {
  RegionShape shape;
  shape.size = 4;
  shape.rows = {0b0101, 0b0000, 0b1000, 0b1111};
  const auto lengths = ShapeAdaptiveDct::row_lengths(shape);
  EXPECT_EQ(lengths[0], 3);
  EXPECT_EQ(lengths[1], 2);
  EXPECT_EQ(lengths[2], 1);
  EXPECT_EQ(lengths[3], 1);
  EXPECT_EQ(lengths[4], 0);

  std::mt19937 random(5);
  for (int round = 0; round < 100; ++round) {
    const RegionShape any = random_shape(random, uniform_int(random, 1, 32));
    int cells = 0;
    for (const std::uint32_t rows : any.rows) cells += std::popcount(rows);
    int sum = 0;
    for (const int length : ShapeAdaptiveDct::row_lengths(any)) sum += length;
    EXPECT_EQ(sum, cells);
  }
}

TEST(ShapeAdaptiveDct, OfNoCellDoesNothing) {
  const ShapeAdaptiveDct transform;
  RegionShape none;
  none.size = 8;
  std::mt19937 random(6);
  RegionValues values = random_values(random);
  const RegionValues before = values;
  transform.forward(none, values);
  transform.inverse(none, values);
  EXPECT_EQ(values, before);
}

}  // namespace
}  // namespace sweepcast::rcpcc
