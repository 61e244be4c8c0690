#include "codec/rcpcc/sa_dct.hpp"

#include <bit>
#include <cmath>

#include "core/trig.hpp"

namespace sweepcast::rcpcc {
namespace {

using Line = std::array<float, kLargestRegion>;

int cells_in(std::uint32_t rows) {
  return std::popcount(rows);
}

}  // namespace

ShapeAdaptiveDct::ShapeAdaptiveDct() {
  for (int length = 1; length <= kLargestRegion; ++length) {
    offset_[static_cast<std::size_t>(length)] = basis_.size();
    for (int p = 0; p < length; ++p) {
      const double norm = std::sqrt((p == 0 ? 1.0 : 2.0) / length);
      for (int k = 0; k < length; ++k) {
        basis_.push_back(static_cast<float>(norm * sin_cos(p * (k + 0.5) * kPi / length).cos));
      }
    }
  }
}

void ShapeAdaptiveDct::transform(int length, const float* in, float* out) const {
  const float* row = basis(length);
  for (int p = 0; p < length; ++p, row += length) {
    float sum = 0.0F;
    for (int k = 0; k < length; ++k) sum += row[k] * in[k];
    out[p] = sum;
  }
}

void ShapeAdaptiveDct::transform_back(int length, const float* in, float* out) const {
  const float* row = basis(length);
  for (int k = 0; k < length; ++k) out[k] = 0.0F;
  for (int p = 0; p < length; ++p, row += length) {
    if (in[p] == 0.0F) continue;  // most coefficients are quantised to nothing
    for (int k = 0; k < length; ++k) out[k] += row[k] * in[p];
  }
}

std::array<int, kLargestRegion> ShapeAdaptiveDct::row_lengths(const RegionShape& shape) {
  std::array<int, kLargestRegion> lengths{};
  for (int c = 0; c < shape.size; ++c) {
    const int cells = cells_in(shape.rows[static_cast<std::size_t>(c)]);
    for (int p = 0; p < cells; ++p) ++lengths[static_cast<std::size_t>(p)];
  }
  return lengths;
}

void ShapeAdaptiveDct::forward(const RegionShape& shape, RegionValues& values) const {
  Line in;
  Line out;
  // Columns: shift up, transform; their coefficients are shifted left as they are stored.
  RegionValues shifted;
  std::array<int, kLargestRegion> lengths{};
  for (std::size_t c = 0; c < static_cast<std::size_t>(shape.size); ++c) {
    int cells = 0;
    for (std::uint32_t rows = shape.rows[c]; rows != 0; rows &= rows - 1) {
      in[static_cast<std::size_t>(cells++)] =
          values[static_cast<std::size_t>(std::countr_zero(rows))][c];
    }
    transform(cells, in.data(), out.data());
    for (std::size_t p = 0; p < static_cast<std::size_t>(cells); ++p) {
      shifted[p][static_cast<std::size_t>(lengths[p]++)] = out[p];
    }
  }
  for (std::size_t p = 0; p < lengths.size() && lengths[p] != 0; ++p) {
    transform(lengths[p], shifted[p].data(), values[p].data());
  }
}

void ShapeAdaptiveDct::inverse(const RegionShape& shape, RegionValues& values) const {
  const auto lengths = row_lengths(shape);
  RegionValues shifted;
  for (std::size_t p = 0; p < lengths.size() && lengths[p] != 0; ++p) {
    transform_back(lengths[p], values[p].data(), shifted[p].data());
  }
  Line in;
  Line out;
  std::array<std::size_t, kLargestRegion> next{};
  for (std::size_t c = 0; c < static_cast<std::size_t>(shape.size); ++c) {
    const int cells = cells_in(shape.rows[c]);
    for (std::size_t p = 0; p < static_cast<std::size_t>(cells); ++p) {
      in[p] = shifted[p][next[p]++];
    }
    transform_back(cells, in.data(), out.data());
    std::size_t k = 0;
    for (std::uint32_t rows = shape.rows[c]; rows != 0; rows &= rows - 1) {
      values[static_cast<std::size_t>(std::countr_zero(rows))][c] = out[k++];
    }
  }
}

}  // namespace sweepcast::rcpcc
