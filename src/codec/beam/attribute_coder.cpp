#include "codec/beam/attribute_coder.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <utility>
#include <variant>

#include "codec/beam/integer_coder.hpp"
#include "codec/beam/intensity_coder.hpp"
#include "codec/beam/intensity_tree_coder.hpp"
#include "codec/entropy/range_coder.hpp"

namespace sweepcast::beam {
namespace {

// Contexts of the integers, apart for each use.
enum Use : std::uint32_t {
  kRowAsTold,
  kRing,
  kBits,
  kExtraRing,
  kExtraTime,
};

// Intensities known so far and their points' ranges, with a margin all around so that neighbours
// need no checks: four strides of the coarsest step.
struct IntensityPlane {
  std::vector<std::int32_t> value;  // -1 where not known
  std::vector<std::int32_t> range;
  std::ptrdiff_t pitch = 0;
  std::ptrdiff_t row_margin = 0;
  std::ptrdiff_t col_margin = 0;

  void reset(const LayerPlan& plan) {
    row_margin = std::ptrdiff_t{4} * plan.lattice.front().row_stride;
    col_margin = std::ptrdiff_t{4} * plan.lattice.front().col_stride;
    pitch = plan.cols + 2 * col_margin;
    const auto cells = static_cast<std::size_t>(pitch * (plan.rows + 2 * row_margin));
    value.assign(cells, -1);
    range.assign(cells, 0);
  }
  [[nodiscard]] std::ptrdiff_t at(int row, int col) const {
    return (row + row_margin) * pitch + col + col_margin;
  }
};

using FastIntensity = IntensityCoder<1>;
using NormalIntensity = IntensityCoder<2>;

// The coder of an effort; what it allocates is kept from sweep to sweep.
class AnyIntensityCoder {
 public:
  void begin(Effort effort, int rows, int bits) {
    switch (effort) {
      case Effort::fast:
        return begin_as<FastIntensity>(rows, bits);
      case Effort::normal:
        return begin_as<NormalIntensity>(rows, bits);
      case Effort::best:
        return begin_as<IntensityTreeCoder>(rows, bits);
    }
  }
  // Calls use(coder).
  template <class Use>
  void visit(Use use) {
    std::visit([&](auto& coder) { use(*coder); }, coder_);
  }

 private:
  template <class Coder>
  void begin_as(int rows, int bits) {
    if (!std::holds_alternative<std::unique_ptr<Coder>>(coder_) ||
        std::get<std::unique_ptr<Coder>>(coder_) == nullptr) {
      coder_ = std::make_unique<Coder>();
    }
    std::get<std::unique_ptr<Coder>>(coder_)->begin(rows, bits);
  }

  std::variant<std::unique_ptr<FastIntensity>, std::unique_ptr<NormalIntensity>,
               std::unique_ptr<IntensityTreeCoder>>
      coder_;
};

}  // namespace

struct AttributeCoder::State {
  AttributeFormat format;
  LayerPlan plan;
  std::vector<std::int32_t> first_col;
  IntensityPlane plane;
  AnyIntensityCoder intensity;
  IntegerCoder numbers;
  RecurrentCoder late;  // how much later than told a point was measured
  std::uint32_t last_bits = 0;
  std::vector<std::int32_t> range;  // of the cells so far
  std::vector<CellState> state;
  std::vector<int> row_cols;  // columns of the points that a step adds to a row

  // What beam and firing tell of a cell's time.
  [[nodiscard]] std::int64_t told_time(int row, int col) const {
    const int first = first_col[static_cast<std::size_t>(row)];
    const int firing = col >= first ? col - first : col + plan.cols - first;
    return wrapped_sum(format.col_time[static_cast<std::size_t>(firing)],
                       format.row_time[static_cast<std::size_t>(row)]);
  }

  template <class Coder>
  std::uint32_t code_bits(Coder& coder, std::uint32_t bits) {
    const std::int64_t rest = numbers.code(coder, std::int64_t{bits} - last_bits, kBits);
    last_bits = static_cast<std::uint32_t>(wrapped_sum(rest, last_bits));
    return last_bits;
  }

  // Intensities of the points at `row_cols` of a row.
  template <class Coder, class Intensity>
  void code_intensities(Coder& coder, Intensity& values, std::uint32_t number, int row,
                        std::vector<std::uint32_t>& cells) {
    const LatticeStep& step = plan.lattice[number];
    // Distances to the next known cell on the axis that the step halves, and on the other.
    std::ptrdiff_t a = step.col_stride;
    std::ptrdiff_t x = step.row_stride * plane.pitch;
    if (step.kind == LatticeStep::Kind::rows) std::swap(a, x);
    const std::array<std::ptrdiff_t, IntensityNeighbours::kCount> offsets{
        -a, a, -2 * a, -x, 2 * a, -3 * a, 3 * a, -4 * a, -x - a, -x + a, x - a, x + a};
    for (const int col : row_cols) {
      if (ran_dry(coder)) return;
      std::uint32_t& value = cells[index(row, col)];
      const std::ptrdiff_t place = plane.at(row, col);
      IntensityNeighbours near;
      for (std::size_t i = 0; i < offsets.size(); ++i) {
        near.value[i] = plane.value[static_cast<std::size_t>(place + offsets[i])];
        near.range[i] = plane.range[static_cast<std::size_t>(place + offsets[i])];
      }
      near.own_range = plane.range[static_cast<std::size_t>(place)];
      const std::int32_t decoded =
          values.code(coder, near, number % (IntensityEstimator::kSets - 1),
                      static_cast<std::size_t>(row), static_cast<std::int32_t>(value));
      plane.value[static_cast<std::size_t>(place)] = decoded;
      value = static_cast<std::uint32_t>(decoded);
    }
  }

  template <class Coder>
  void code_row(Coder& coder, std::uint32_t number, int row, std::vector<std::uint32_t>& cells) {
    if (format.unit.kind == IntensityUnit::Kind::bits) return code_bits_of_row(coder, row, cells);
    intensity.visit([&](auto& values) { code_intensities(coder, values, number, row, cells); });
  }

  // Intensities that are floats' bits.
  template <class Coder>
  void code_bits_of_row(Coder& coder, int row, std::vector<std::uint32_t>& cells) {
    for (const int col : row_cols) {
      if (ran_dry(coder)) return;
      std::uint32_t& value = cells[index(row, col)];
      value = code_bits(coder, value);
    }
  }

  template <class Coder>
  void code_rings(Coder& coder, int row, std::vector<std::uint16_t>& rings) {
    const std::uint16_t told = format.row_ring[static_cast<std::size_t>(row)];
    const bool exceptions = std::any_of(row_cols.begin(), row_cols.end(),
                                        [&](int col) { return rings[index(row, col)] != told; });
    const bool some = numbers.code(coder, exceptions ? 1 : 0, kRowAsTold) != 0;
    for (const int col : row_cols) {
      std::uint16_t& ring = rings[index(row, col)];
      std::int64_t rest = 0;
      if (some && !ran_dry(coder)) rest = numbers.code(coder, std::int64_t{ring} - told, kRing);
      ring = static_cast<std::uint16_t>(wrapped_sum(rest, told));
    }
  }

  template <class Coder>
  void code_times(Coder& coder, int row, std::vector<std::int64_t>& times) {
    const bool exceptions = std::any_of(row_cols.begin(), row_cols.end(), [&](int col) {
      return times[index(row, col)] != told_time(row, col);
    });
    const bool some = numbers.code(coder, exceptions ? 1 : 0, kRowAsTold) != 0;
    for (const int col : row_cols) {
      std::int64_t& time = times[index(row, col)];
      const std::int64_t told = told_time(row, col);
      // Where the sweep's seam is crossed, or a firing is told too early, differences come again;
      // and what a driver rounded once it rounds alike again.
      const auto bits = static_cast<std::uint64_t>(told);
      const std::uint32_t context =
          hash_context(static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32));
      std::int64_t rest = 0;
      if (some && !ran_dry(coder)) rest = late.code(coder, wrapped_difference(time, told), context);
      time = wrapped_sum(told, rest);
    }
  }

  template <class Coder>
  void code_layer(Coder& coder, int layer, const LayerCoder& layers, AttributeValues& cells) {
    layers.read(range, state);
    const auto [first, last] = steps_of(plan.lattice, layer);
    for (std::uint32_t number = first; number < last; ++number) {
      const LatticeStep& step = plan.lattice[number];
      const Traversal at(step);
      for (int row = at.first_row; row < plan.rows; row += at.row_stride) {
        row_cols.clear();
        for (int col = at.first_col; col < plan.cols; col += at.col_stride) {
          if (state[index(row, col)] != CellState::measured) continue;
          row_cols.push_back(col);
          if (!format.has_intensity) continue;
          plane.range[static_cast<std::size_t>(plane.at(row, col))] = range[index(row, col)];
        }
        if (row_cols.empty() || ran_dry(coder)) continue;
        if (format.has_intensity) code_row(coder, number, row, cells.intensity);
        if (format.has_ring) code_rings(coder, row, cells.ring);
        if (format.has_time) code_times(coder, row, cells.time);
      }
    }
  }

  template <class Coder, class Intensity>
  void code_extra_intensities(Coder& coder, Intensity& coded, std::vector<std::uint32_t>& values) {
    IntensityNeighbours near;
    near.value.fill(-1);
    near.own_range = 64;  // the same for all: neighbours count fully
    near.range.fill(near.own_range);
    // Those before in the order of the octree, taken for one, two, three and four steps back.
    constexpr std::array<std::size_t, 4> kBack{0, 2, 5, 7};
    for (std::uint32_t& value : values) {
      if (ran_dry(coder)) return;
      const std::int32_t decoded =
          coded.code(coder, near, IntensityEstimator::kSets - 1,
                     static_cast<std::size_t>(plan.rows), static_cast<std::int32_t>(value));
      for (std::size_t i = kBack.size() - 1; i > 0; --i) {
        near.value[kBack[i]] = near.value[kBack[i - 1]];
      }
      near.value[kBack[0]] = decoded;
      value = static_cast<std::uint32_t>(decoded);
    }
  }

  template <class Coder>
  void code_extras(Coder& coder, AttributeValues& extras) {
    if (format.has_intensity && format.unit.kind == IntensityUnit::Kind::bits) {
      for (std::uint32_t& value : extras.intensity) {
        if (ran_dry(coder)) return;
        value = code_bits(coder, value);
      }
    } else if (format.has_intensity) {
      intensity.visit(
          [&](auto& values) { code_extra_intensities(coder, values, extras.intensity); });
    }
    std::int64_t before = 0;
    for (std::uint16_t& ring : extras.ring) {
      if (ran_dry(coder)) return;
      before += numbers.code(coder, std::int64_t{ring} - before, kExtraRing);
      ring = static_cast<std::uint16_t>(before);
      before = ring;
    }
    before = 0;
    for (std::int64_t& time : extras.time) {
      if (ran_dry(coder)) return;
      before =
          wrapped_sum(before, numbers.code(coder, wrapped_difference(time, before), kExtraTime));
      time = before;
    }
  }

 private:
  [[nodiscard]] std::size_t index(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(plan.cols) +
           static_cast<std::size_t>(col);
  }
};

AttributeCoder::AttributeCoder() : state_(std::make_unique<State>()) {}
AttributeCoder::AttributeCoder(AttributeCoder&&) noexcept = default;
AttributeCoder& AttributeCoder::operator=(AttributeCoder&&) noexcept = default;
AttributeCoder::~AttributeCoder() = default;

void AttributeCoder::begin(const AttributeFormat& format, const LayerPlan* plan,
                           std::span<const std::int32_t> first_col) {
  State& s = *state_;
  s.format = format;
  if (plan != nullptr) {
    s.plan = *plan;
  } else {
    s.plan = {};
  }
  s.first_col.assign(first_col.begin(), first_col.end());
  s.numbers.reset();
  s.late.reset();
  s.last_bits = 0;
  if (!format.has_intensity) return;
  if (plan != nullptr) s.plane.reset(*plan);
  s.intensity.begin(s.plan.effort, s.plan.rows, format.unit.width);
}

void AttributeCoder::encode(int layer, const LayerCoder& layers, AttributeValues& cells,
                            std::vector<std::byte>& out) {
  RangeEncoder coder(out);
  state_->code_layer(coder, layer, layers, cells);
  coder.finish();
}

bool AttributeCoder::decode(int layer, const LayerCoder& layers, std::span<const std::byte> bytes,
                            AttributeValues& cells) {
  RangeDecoder coder(bytes);
  state_->code_layer(coder, layer, layers, cells);
  return !coder.overran();
}

void AttributeCoder::encode_extras(AttributeValues& extras, std::vector<std::byte>& out) {
  RangeEncoder coder(out);
  state_->code_extras(coder, extras);
  coder.finish();
}

bool AttributeCoder::decode_extras(std::span<const std::byte> bytes, AttributeValues& extras) {
  RangeDecoder coder(bytes);
  state_->code_extras(coder, extras);
  return !coder.overran();
}

}  // namespace sweepcast::beam
