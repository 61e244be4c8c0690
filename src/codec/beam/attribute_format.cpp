#include "codec/beam/attribute_format.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <type_traits>

#include "codec/beam/integer_coder.hpp"
#include "codec/beam/ordered_float.hpp"
#include "codec/entropy/range_coder.hpp"

namespace sweepcast::beam {
namespace {

constexpr std::int64_t kMostValues = 65'536;
constexpr std::size_t kLargestPalette = 2048;
constexpr std::int64_t kLargestOffset = std::int64_t{1} << 50;
constexpr double kLargestIntensityStep = 1e12;
constexpr int kRounds = 3;  // of medians by turns over rows and columns

float scaled(const IntensityUnit& unit, std::int64_t value) {
  return static_cast<float>(static_cast<double>(value + unit.offset) * unit.step / unit.divisor);
}

std::int64_t nearest_multiple(const IntensityUnit& unit, float intensity) {
  return static_cast<std::int64_t>(std::floor(double{intensity} * unit.divisor / unit.step + 0.5));
}

// Sets offset and width to the values' extent; false where that is too wide.
bool set_extent(std::span<const float> values, IntensityUnit& unit) {
  constexpr double kFarthest = 1e15;
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  std::int64_t most = std::numeric_limits<std::int64_t>::min();
  for (const float value : values) {
    if (!(std::abs(double{value} * unit.divisor) < kFarthest * unit.step)) return false;
    const std::int64_t multiple = nearest_multiple(unit, value);
    least = std::min(least, multiple);
    most = std::max(most, multiple);
  }
  if (most - least >= kMostValues) return false;
  // The usual extents start at zero.
  unit.offset = least >= 0 && most < kMostValues ? 0 : least;
  const auto extent = static_cast<std::uint64_t>(most - unit.offset);
  unit.width = std::max(1, static_cast<int>(std::bit_width(extent)));
  return true;
}

bool is_exact(std::span<const float> values, const IntensityUnit& unit) {
  return std::all_of(values.begin(), values.end(), [&](float value) {
    const float back = scaled(unit, nearest_multiple(unit, value) - unit.offset);
    return std::bit_cast<std::uint32_t>(back) == std::bit_cast<std::uint32_t>(value);
  });
}

bool make_palette(std::span<const float> values, IntensityUnit& unit) {
  std::vector<std::uint32_t> distinct;
  std::vector<bool> seen(kMostValues);  // by a hash, to keep the list short
  for (const float value : values) {
    const std::uint32_t bits = ordered_bits(value);
    const std::size_t slot = hash_context(bits, 0) % kMostValues;
    if (seen[slot] && std::find(distinct.rbegin(), distinct.rend(), bits) != distinct.rend()) {
      continue;
    }
    if (distinct.size() == kLargestPalette) return false;
    seen[slot] = true;
    distinct.push_back(bits);
  }
  std::sort(distinct.begin(), distinct.end());
  for (const std::uint32_t bits : distinct) unit.palette.push_back(float_of_ordered(bits));
  unit.width = std::max(1, static_cast<int>(std::bit_width(distinct.size() - 1)));
  return true;
}

template <class T>
T median(std::vector<T>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Codes a table as differences, each predicted by the one before. Gives back the decoded values.
template <class Coder, class T>
void code_table(Coder& coder, IntegerCoder& numbers, std::vector<T>& table, std::uint32_t context) {
  std::int64_t last = 0;
  std::int64_t slope = 0;
  for (T& entry : table) {
    const std::int64_t predicted = wrapped_sum(last, slope);
    const std::int64_t rest =
        numbers.code(coder, wrapped_difference(std::int64_t{entry}, predicted), context);
    const std::int64_t value = wrapped_sum(predicted, rest);
    slope = wrapped_difference(value, last);
    last = value;
    entry = static_cast<T>(value);
  }
}

// Codes times of firings, rising by steps of which a few come again and again: drivers derive times
// from packets.
template <class Coder>
void code_firing_times(Coder& coder, std::vector<std::int64_t>& times) {
  RecurrentCoder steps;
  std::int64_t last = 0;
  for (std::int64_t& time : times) {
    last = wrapped_sum(last, steps.code(coder, wrapped_difference(time, last), 0));
    time = last;
  }
}

// One function for both directions; false where decoded numbers cannot be right.
template <class Coder>
bool code_format(Coder& coder, AttributeFormat& f) {
  IntegerCoder numbers;
  const auto code = [&](auto& number) {
    using Number = std::remove_reference_t<decltype(number)>;
    number = static_cast<Number>(numbers.code(coder, static_cast<std::int64_t>(number), 0));
  };
  for (bool* has : {&f.has_intensity, &f.has_ring, &f.has_time}) code(*has);
  if (f.has_intensity) {
    IntensityUnit& unit = f.unit;
    auto step = std::bit_cast<std::uint64_t>(unit.step);
    std::uint64_t colours = unit.palette.size();
    code(unit.kind);
    code(unit.width);
    code(unit.divisor);
    code(unit.offset);
    code(step);
    code(colours);
    unit.step = std::bit_cast<double>(step);
    if (unit.kind > IntensityUnit::Kind::bits || unit.width < 1 || unit.width > 16 ||
        unit.divisor < 1 || !(unit.step > 0 && unit.step <= kLargestIntensityStep) ||
        unit.offset < -kLargestOffset || unit.offset > kLargestOffset ||
        colours > kLargestPalette || (unit.kind == IntensityUnit::Kind::palette && colours == 0)) {
      return false;
    }
    std::vector<std::uint32_t> bits(colours);
    std::transform(unit.palette.begin(), unit.palette.end(), bits.begin(), ordered_bits);
    code_table(coder, numbers, bits, 1);
    unit.palette.resize(colours);
    std::transform(bits.begin(), bits.end(), unit.palette.begin(), float_of_ordered);
  }
  if (f.has_ring) code_table(coder, numbers, f.row_ring, 2);
  if (f.has_time) {
    code(f.time_base);
    code(f.time_quantum);
    code_table(coder, numbers, f.row_time, 3);
    code_firing_times(coder, f.col_time);
  }
  return true;
}

}  // namespace

IntensityUnit find_unit(std::span<const float> values, double step) {
  struct Candidate {
    double step;
    std::int32_t divisor;
  };
  // Whole numbers; shares of 100, 255, 256, 1000, 65535; hundredths that were rescaled to 255.
  constexpr std::array<Candidate, 8> kCandidates{
      {{1, 1}, {1, 100}, {1, 255}, {255, 100}, {1, 256}, {100, 255}, {1, 1000}, {1, 65'535}}};
  IntensityUnit unit;
  if (values.empty()) return unit;
  unit.kind = IntensityUnit::Kind::scaled;
  if (step > 0) {
    unit.step = step;
    if (set_extent(values, unit)) return unit;
  }
  for (const Candidate& candidate : kCandidates) {
    unit.step = candidate.step;
    unit.divisor = candidate.divisor;
    if (set_extent(values, unit) && is_exact(values, unit)) return unit;
  }
  IntensityUnit palette;
  palette.kind = IntensityUnit::Kind::palette;
  if (make_palette(values, palette)) return palette;
  return {};
}

std::uint32_t intensity_value(const IntensityUnit& unit, float intensity) {
  switch (unit.kind) {
    case IntensityUnit::Kind::scaled:
      return static_cast<std::uint32_t>(nearest_multiple(unit, intensity) - unit.offset);
    case IntensityUnit::Kind::palette:
      return static_cast<std::uint32_t>(
          std::lower_bound(unit.palette.begin(), unit.palette.end(), intensity,
                           [](float a, float b) { return ordered_bits(a) < ordered_bits(b); }) -
          unit.palette.begin());
    case IntensityUnit::Kind::bits:
      break;
  }
  return ordered_bits(intensity);
}

float intensity_of(const IntensityUnit& unit, std::uint32_t value) {
  switch (unit.kind) {
    case IntensityUnit::Kind::scaled:
      return scaled(unit, value);
    case IntensityUnit::Kind::palette:
      return unit.palette[std::min<std::size_t>(value, unit.palette.size() - 1)];
    case IntensityUnit::Kind::bits:
      break;
  }
  return float_of_ordered(value);
}

void find_time_unit(std::span<const std::int64_t> times, AttributeFormat& format) {
  format.time_base = times.empty() ? 0 : *std::min_element(times.begin(), times.end());
  std::int64_t quantum = 0;
  for (const std::int64_t time : times) {
    quantum = std::gcd(quantum, time - format.time_base);
    if (quantum == 1) break;
  }
  format.time_quantum = std::max<std::int64_t>(quantum, 1);
}

void fit_tables(const LayerPlan& plan, std::span<const std::int32_t> first_col,
                std::span<const std::int32_t> range, const AttributeValues& cells,
                AttributeFormat& format) {
  const auto rows = static_cast<std::size_t>(plan.rows);
  const auto cols = static_cast<std::size_t>(plan.cols);
  format.row_ring.assign(format.has_ring ? rows : 0, 0);
  format.row_time.assign(format.has_time ? rows : 0, 0);
  format.col_time.assign(format.has_time ? cols : 0, 0);
  // Calls visit(cell) for the points of a row; the cell's firing is `firing_of(row, col)`.
  const auto firing_of = [&](std::size_t row, std::size_t col) {
    const auto first = static_cast<std::size_t>(first_col[row]);
    return col >= first ? col - first : col + cols - first;
  };
  if (format.has_ring) {
    std::vector<std::uint16_t> rings;
    for (std::size_t row = 0; row < rows; ++row) {
      rings.clear();
      for (std::size_t cell = row * cols; cell < (row + 1) * cols; ++cell) {
        if (range[cell] != 0) rings.push_back(cells.ring[cell]);
      }
      // The median is the most frequent one wherever one has the majority.
      format.row_ring[row] = rings.empty() ? std::uint16_t{0} : median(rings);
    }
  }
  if (!format.has_time) return;
  std::vector<std::int64_t> differences;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t firing = 0; firing < cols; ++firing) {
      differences.clear();
      for (std::size_t row = 0; row < rows; ++row) {
        const std::size_t col = (firing + static_cast<std::size_t>(first_col[row])) % cols;
        const std::size_t cell = row * cols + col;
        if (range[cell] != 0) differences.push_back(cells.time[cell] - format.row_time[row]);
      }
      const std::int64_t before = firing > 0 ? format.col_time[firing - 1] : 0;
      const std::int64_t slope = firing > 1 ? before - format.col_time[firing - 2] : 0;
      format.col_time[firing] = differences.empty() ? before + slope : median(differences);
    }
    if (round == kRounds - 1) return;
    for (std::size_t row = 0; row < rows; ++row) {
      differences.clear();
      for (std::size_t col = 0; col < cols; ++col) {
        const std::size_t cell = row * cols + col;
        if (range[cell] == 0) continue;
        differences.push_back(cells.time[cell] - format.col_time[firing_of(row, col)]);
      }
      format.row_time[row] = differences.empty() ? 0 : median(differences);
    }
  }
}

void write_format(const AttributeFormat& format, std::vector<std::byte>& out) {
  RangeEncoder coder(out);
  AttributeFormat copy = format;
  code_format(coder, copy);
  coder.finish();
}

bool read_format(std::span<const std::byte> bytes, int rows, int cols, AttributeFormat& format) {
  format = {};
  format.row_ring.resize(static_cast<std::size_t>(rows));
  format.row_time.resize(static_cast<std::size_t>(rows));
  format.col_time.resize(static_cast<std::size_t>(cols));
  RangeDecoder coder(bytes);
  return code_format(coder, format) && !coder.overran();
}

}  // namespace sweepcast::beam
