// Attributes as integers: the unit of each column, found in the sweep, and what of ring and time
// follows from a point's beam and firing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/beam/range_layers.hpp"
#include "sweepcast/cloud.hpp"
#include "sweepcast/encoder.hpp"

namespace sweepcast::beam {

/// The attributes of points or cells as integers, one entry each; columns that are not coded are
/// empty.
struct AttributeValues {
  std::vector<std::uint32_t> intensity;
  std::vector<std::uint16_t> ring;
  std::vector<std::int64_t> time;

  void resize(std::size_t count, bool has_intensity, bool has_ring, bool has_time) {
    intensity.assign(has_intensity ? count : 0, 0);
    ring.assign(has_ring ? count : 0, 0);
    time.assign(has_time ? count : 0, 0);
  }
};

/// How an intensity becomes an integer.
struct IntensityUnit {
  enum class Kind : std::uint8_t {
    scaled,   ///< intensity = float((value + offset) * step / divisor), in double
    palette,  ///< intensity = palette[value]
    bits,     ///< value is the float's 32 bits
  };
  Kind kind = Kind::bits;
  double step = 1.0;
  std::int32_t divisor = 1;
  std::int64_t offset = 0;
  int width = 16;                ///< bits of a value, 1 to 16; not for kind `bits`
  std::vector<float> palette{};  ///< rising as floats' bits
};

/// What encoder and decoder must agree on before the first point.
struct AttributeFormat {
  bool has_intensity = false;
  bool has_ring = false;
  bool has_time = false;
  IntensityUnit unit;
  std::int64_t time_base = 0;  ///< ns; time = base + quantum * value
  std::int64_t time_quantum = 1;

  // A cell's ring and time as its place tells them: exceptions are coded. Empty without an image.
  std::vector<std::uint16_t> row_ring;
  std::vector<std::int64_t> row_time, col_time;  ///< to be added; columns are firings
};

/// Finds the unit in which all values are exact: an integer multiple of a common unit, one of a
/// few values, or else the floats' bits. With a `step` (not 0) values are rounded to its multiples
/// where all are finite and fewer than 2^16 steps apart.
[[nodiscard]] IntensityUnit find_unit(std::span<const float> values, double step);

/// The integer of a value; `unit` must come from `find_unit` over a sweep that has the value.
[[nodiscard]] std::uint32_t intensity_value(const IntensityUnit& unit, float intensity);
/// The inverse; total: any integer gives some float.
[[nodiscard]] float intensity_of(const IntensityUnit& unit, std::uint32_t value);

/// Sets base and quantum: the smallest time, and the largest unit that divides all differences.
void find_time_unit(std::span<const std::int64_t> times, AttributeFormat& format);

/// Sets what rows and columns tell: each row's most frequent ring, and medians of the times.
/// `range` and `cells` are the coded image's planes, row-major; range is 0 where no point is;
/// `first_col[row]` is where the row's firing 0 stands.
void fit_tables(const LayerPlan& plan, std::span<const std::int32_t> first_col,
                std::span<const std::int32_t> range, const AttributeValues& cells,
                AttributeFormat& format);

void write_format(const AttributeFormat& format, std::vector<std::byte>& out);

/// The inverse, for an image of `rows` x `cols`; false where it cannot be right.
[[nodiscard]] bool read_format(std::span<const std::byte> bytes, int rows, int cols,
                               AttributeFormat& format);

}  // namespace sweepcast::beam
