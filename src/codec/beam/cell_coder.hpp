// Codes the cells of a range image one by one: whether a cell holds a point, and its range as the
// difference from a prediction. Everything here is integer arithmetic, and one function serves
// encoder and decoder, so that they cannot disagree.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "codec/beam/neighbourhood.hpp"
#include "codec/entropy/mixer.hpp"

namespace sweepcast::beam {

/// Codes cells: decoded ranges differ from the true ones by at most half the step of ranges.
/// `Coder` is RangeEncoder or RangeDecoder.
class CellCoder {
 public:
  using Cell = PaddedImage::Cell;

  explicit CellCoder(int table_bits)
      : group_(10, 8),
        mask_(table_bits, 256),
        pick_(table_bits, 16),
        zero_(table_bits, 256),
        sign_(table_bits, 8),
        magnitude_(table_bits, 64) {}

  /// Begins an image with this step of ranges; forgets what was learnt.
  void begin(std::int32_t step) {
    step_ = step;
    edge_ = std::max(4'000, 4 * step);
    per_step_ = (std::uint64_t{8} << 32) / static_cast<std::uint64_t>(step);
    group_.reset();
    mask_.reset();
    pick_.reset();
    zero_.reset();
    sign_.reset();
    magnitude_.reset();
  }

  /// Codes whether a cell holds a point. Encoding: `occupied` is the truth; decoding: not used.
  template <class Coder>
  void code_state(Coder& coder, Cell* cell, const Neighbourhood& n, bool occupied,
                  std::uint32_t row, std::uint32_t col) {
    cell->state = code_mask(coder, View(cell, n), n, row, col, occupied) ? 2 : 1;
  }

  /// Codes whether all of `count` cells, `stride` apart, are as their neighbours let expect, and
  /// if so, sets them. Encoding: `range` has the true ranges at the same stride.
  template <class Coder>
  bool code_group(Coder& coder, Cell* cells, std::ptrdiff_t stride, int count,
                  const Neighbourhood& n, const std::int32_t* range, std::uint32_t& history) {
    std::uint32_t doubtful = 0;
    bool as_expected = true;
    for (int i = 0; i < count; ++i) {
      Cell* cell = cells + i * stride;
      const std::uint8_t a = cell[-n.along].state;
      const std::uint8_t b = cell[n.along].state;
      const std::uint8_t across = cell[-n.across].state;
      const bool sure = a == b && (across == 0 || across == a);
      doubtful += sure ? 0U : a == b ? 1U : 2U;
      cell->state = expected(a, b, across);
      if (range != nullptr) as_expected &= (range[i * stride] != 0) == (cell->state == 2);
    }
    const std::uint32_t doubt = std::min(doubtful, 7U);
    const BitMixer<4>::Contexts contexts{
        hash_context(doubt, n.step), hash_context(doubt * 16U + (history & 15U), 10U),
        hash_context(history & 255U, 20U + doubt / 2U),
        hash_context(doubtful * 4U + (history & 3U), 30U + n.step)};
    const bool same = group_.code(coder, contexts, doubt, as_expected);
    history = history * 2U + (same ? 1U : 0U);
    if (!same) {
      for (int i = 0; i < count; ++i) cells[i * stride].state = 0;
    }
    return same;
  }

  /// Codes the range of a cell that holds a point. Encoding: `range` is the true one.
  template <class Coder>
  void code_range(Coder& coder, Cell* cell, const Neighbourhood& n, std::int32_t range) {
    const View v = View(cell, n);
    const Prediction p = predict(coder, v, n, range);
    const std::int32_t steps = code_residual(coder, v, n, p, range);
    const std::int64_t decoded = p.range + std::int64_t{steps} * step_;
    cell->range = static_cast<std::int32_t>(std::clamp<std::int64_t>(decoded, kNearest, kFarthest));
    cell->inverse = inverse_of(cell->range);
    cell->activity = static_cast<std::uint8_t>(std::min(std::abs(steps), 20));
  }

 private:
  static std::uint8_t expected(std::uint8_t a, std::uint8_t b, std::uint8_t across) {
    if (a == b && a != 0) return a;
    if (across != 0) return across;
    return a != 0 ? a : b != 0 ? b : std::uint8_t{2};
  }

  struct Prediction {
    std::int32_t range;
    std::int32_t carried;  // from across, 0 where there is none
    std::int32_t spread;   // how far the candidates lie apart
    std::uint32_t type;    // 0 between two sides, 1 and 2 at an edge, 3 one side, 4 across, 5 guess
  };

  // How many steps, roughly logarithmically: 0 to 9.
  [[nodiscard]] std::uint32_t scale(std::int32_t difference) const {
    const std::uint64_t eighths =
        (static_cast<std::uint64_t>(std::abs(difference)) * per_step_) >> 32;
    return kScale[std::min<std::uint64_t>(eighths, 255)];
  }
  [[nodiscard]] std::uint32_t signed_scale(std::int32_t difference) const {
    return scale(difference) + (difference < 0 ? 0 : 10);
  }

  template <class Coder>
  bool code_mask(Coder& coder, const View& v, const Neighbourhood& n, std::uint32_t row,
                 std::uint32_t col, bool occupied) {
    const std::uint32_t sides = v.a->state * 3U + v.b->state;
    const std::uint32_t near = ((sides * 3U + v.n->state) * 3U + v.sa->state) * 3U + v.sb->state;
    const std::int32_t ra = v.a->range;
    const std::int32_t rb = v.b->range;
    const std::uint32_t jump =
        ra > 0 && rb > 0 ? static_cast<std::uint32_t>(std::min(3, std::abs(ra - rb) / 10'000)) : 4U;
    const std::uint32_t far = log2_quarters(static_cast<std::uint32_t>(std::max(ra, rb))) / 4U;
    const std::uint32_t across = v.na->state * 3U + v.nb->state;
    const BitMixer<7>::Contexts contexts{
        hash_context(near, n.step),
        hash_context(near * 27U + across * 3U + v.nn->state, 100U + n.step),
        hash_context(
            ((sides * 3U + v.aa->state) * 3U + v.bb->state) * 9U + v.aaa->state * 3U + v.bbb->state,
            200U + n.step + (static_cast<std::uint32_t>(v.n->state) << 8)),
        hash_context(row * 9U + sides, 300U + v.n->state),
        hash_context(((v.n->state * 3U + v.nn->state) * 3U + v.nnn->state) * 81U + across * 9U +
                         v.nna->state * 3U + v.nnb->state,
                     400U + n.step * 9U + sides),
        hash_context(far * 5U + jump, sides * 9U + v.n->state * 3U + (n.step << 8)),
        hash_context((col / 16U) * 3U + v.n->state, sides * 7U + 600U + (row / 8U) * 100U)};
    return mask_.code(coder, contexts, sides * 9U + v.n->state * 3U + v.sa->state, occupied);
  }

  template <class Coder>
  Prediction predict(Coder& coder, const View& v, const Neighbourhood& n, std::int32_t range) {
    const std::int32_t ra = v.a->range;
    const std::int32_t rb = v.b->range;
    const std::int32_t rn = v.n->range;
    const std::int32_t carried = carry(v);
    if (ra > 0 && rb > 0) {
      const std::int32_t between = range_of(interpolate(v.a->inverse, v.b->inverse, n.weight));
      const std::int32_t apart = std::abs(ra - rb);
      if (apart > edge_) return predict_at_edge(coder, v, n, between, carried, range);
      std::int32_t blended = between;
      if (carried > 0 && std::abs(carried - between) < edge_) {
        // Trust what is carried from across as far as interpolation failed there.
        std::int64_t failed = step_;
        if (v.na->range > 0 && v.nb->range > 0) {
          failed = range_of(interpolate(v.na->inverse, v.nb->inverse, n.weight)) - rn;
        }
        const std::int64_t noise = step_ / 2 + 200;
        const std::int64_t squared = failed * failed;
        const std::int64_t share = squared * 52'429 / (squared + noise * noise * 4);  // 0.8 at most
        blended += static_cast<std::int32_t>(((carried - between) * share) >> 16);
      }
      return {blended, carried, apart, 0};
    }
    if (ra > 0 || rb > 0) {
      std::int32_t side = ra > 0 ? ra : rb;
      const std::int32_t beyond = ra > 0 ? v.aa->range : v.bb->range;
      if (carried > 0 && std::abs(carried - side) < edge_) {
        side = carried;
      } else if (beyond > 0 && std::abs(beyond - side) < edge_) {
        const std::uint32_t here = ra > 0 ? v.a->inverse : v.b->inverse;
        const std::uint32_t there = ra > 0 ? v.aa->inverse : v.bb->inverse;
        const std::int64_t onward = 2 * std::int64_t{here} - there;
        const std::int32_t line = onward > 0 ? range_of(static_cast<std::uint64_t>(onward)) : side;
        if (std::abs(line - side) < edge_) side = line;
      }
      return {side, carried, rn > 0 ? std::abs(rn - side) : edge_, 3};
    }
    if (rn > 0) return {rn, carried, v.nn->range > 0 ? std::abs(rn - v.nn->range) : edge_, 4};
    for (const Cell* cell : {v.na, v.nb, v.sa, v.sb, v.aa, v.bb, v.nn, v.aaa, v.bbb, v.nnn}) {
      if (cell->range > 0) return {cell->range, carried, edge_, 5};
    }
    return {kTypical, carried, edge_, 5};
  }

  // A jump in depth between both sides: the encoder says which side the cell belongs to.
  template <class Coder>
  Prediction predict_at_edge(Coder& coder, const View& v, const Neighbourhood& n,
                             std::int32_t between, std::int32_t carried, std::int32_t range) {
    const std::int32_t ra = v.a->range;
    const std::int32_t rb = v.b->range;
    const std::int32_t rn = v.n->range;
    const auto differ = [](std::int32_t x, std::int32_t y) { return std::abs(x - y); };
    std::uint32_t across = 3;
    if (rn > 0 && v.na->range > 0 && v.nb->range > 0) {
      const std::int32_t to_a = differ(rn, v.na->range);
      const std::int32_t to_b = differ(rn, v.nb->range);
      if (differ(v.na->range, v.nb->range) >= edge_) {
        across = to_a < to_b ? (to_a < edge_ ? 0U : 2U) : (to_b < edge_ ? 1U : 2U);
      }
    } else if (rn > 0) {
      const std::int32_t to_a = differ(rn, ra);
      const std::int32_t to_b = differ(rn, rb);
      across = to_a < to_b ? (to_a < edge_ ? 4U : 6U) : (to_b < edge_ ? 5U : 6U);
    }
    std::uint32_t below = 0;
    if (v.sa->range > 0 && v.sb->range > 0) {
      below =
          (differ(v.sa->range, ra) < edge_ ? 1U : 0U) + (differ(v.sb->range, rb) < edge_ ? 2U : 0U);
    } else {
      below = 4U + (v.sa->range > 0 ? 1U : 0U) + (v.sb->range > 0 ? 2U : 0U);
    }
    const std::uint32_t goes_on = (v.aa->range > 0 && differ(v.aa->range, ra) < edge_ ? 1U : 0U) +
                                  (v.bb->range > 0 && differ(v.bb->range, rb) < edge_ ? 2U : 0U);
    const std::uint32_t rising = ra < rb ? 1U : 0U;
    BitMixer<4>::Contexts contexts{
        hash_context(across * 8U + below, n.step),
        hash_context(across * 4U + goes_on, 50U + rising),
        hash_context(scale(ra - rb), 60U + across),
        hash_context((across * 8U + below) * 4U + goes_on, 70U + rising + n.step * 2U)};
    const std::int32_t to_between = differ(range, between);
    const bool is_side = to_between > std::min(differ(range, ra), differ(range, rb));
    if (!pick_.code(coder, contexts, rising, is_side)) {
      return {between, carried, differ(ra, rb), 1};
    }
    for (std::uint32_t& context : contexts) context = hash_context(context, 99);
    const bool is_b = differ(range, rb) < differ(range, ra);
    const bool picked_b = pick_.code(coder, contexts, 8U + rising, is_b);
    return {picked_b ? rb : ra, carried, edge_, 2};
  }

  // The line across carried on with the slope seen beside it, in inverse range; 0 where unknown.
  [[nodiscard]] static std::int32_t carry(const View& v) {
    if (v.n->range == 0) return 0;
    std::int64_t change = 0;
    int sides = 0;
    if (v.a->range > 0 && v.na->range > 0) {
      change += std::int64_t{v.a->inverse} - v.na->inverse;
      ++sides;
    }
    if (v.b->range > 0 && v.nb->range > 0) {
      change += std::int64_t{v.b->inverse} - v.nb->inverse;
      ++sides;
    }
    if (sides == 0) return 0;
    const std::int64_t inverse = v.n->inverse + (sides == 2 ? change / 2 : change);
    if (inverse < static_cast<std::int64_t>(kInverseOne / 2'000'000)) return 0;
    return range_of(static_cast<std::uint64_t>(inverse));
  }

  template <class Coder>
  std::int32_t code_residual(Coder& coder, const View& v, const Neighbourhood& n,
                             const Prediction& p, std::int32_t range) {
    const std::int32_t difference = range - p.range;
    const std::int32_t count = (std::abs(difference) + step_ / 2) / step_;
    const std::uint32_t kind = p.type * 8U + n.step;
    const std::uint32_t mean = mean_activity(v);
    const auto offset = [&](std::int32_t r) { return r > 0 ? signed_scale(r - p.range) : 20U; };
    const std::uint32_t to_n = offset(v.n->range);
    const std::uint32_t to_carried = offset(p.carried);
    const std::uint32_t slope =
        signed_scale(v.a->range > 0 && v.b->range > 0 ? v.a->range - v.b->range : 0);
    const bool across_known = v.na->range > 0 && v.nb->range > 0;
    const std::uint32_t slope_n = across_known ? scale(v.na->range - v.nb->range) : 10U;
    const std::uint32_t bend =
        across_known && v.n->range > 0
            ? signed_scale(v.n->range -
                           range_of((std::uint64_t{v.na->inverse} + v.nb->inverse) / 2))
            : 20U;
    const std::uint32_t far = log2_quarters(static_cast<std::uint32_t>(p.range));
    const std::uint32_t spread = scale(p.spread);
    const BitMixer<4>::Contexts c{
        hash_context(kind, spread * 16U + mean),
        hash_context(kind, 20'000U + (slope * 21U + bend) * 11U + slope_n),
        hash_context(kind, 60'000U + to_carried * 21U + to_n),
        hash_context(kind, 300'000U + (mean * 21U + to_carried) * 64U + far)};
    if (!zero_.code(coder, c, p.type * 40U + n.step * 8U % 40U + mean / 2U, count != 0)) return 0;
    const BitMixer<3>::Contexts s{
        hash_context(kind, slope * 21U + bend),
        hash_context(kind, 1'000U + to_carried * 21U + to_n),
        hash_context(kind, 4'000U + to_n * 8U + (v.a->range > p.range ? 1U : 0U) +
                               (v.b->range > p.range ? 2U : 0U))};
    const bool negative = sign_.code(coder, s, p.type, difference < 0);
    const std::int32_t size = code_magnitude(coder, c, kind, mean, negative, count);
    return negative ? -size : size;
  }

  // At least 1: in unary while small, then by the Elias-gamma code.
  template <class Coder>
  std::int32_t code_magnitude(Coder& coder, const BitMixer<4>::Contexts& c, std::uint32_t kind,
                              std::uint32_t mean, bool negative, std::int32_t count) {
    const std::uint32_t sign = negative ? 64U : 0U;
    std::int32_t size = 1;
    for (std::uint32_t i = 0; i < kUnary; ++i) {
      const BitMixer<4>::Contexts contexts{
          hash_context(c[0], i + 1), hash_context(c[1], i + 1 + sign),
          hash_context(c[2], i + 1 + sign), hash_context(kind * 32U + i, mean)};
      if (!magnitude_.code(coder, contexts, i + (kind >= 16U ? 32U : 0U), count > size))
        return size;
      ++size;
    }
    return size + static_cast<std::int32_t>(
                      code_gamma(coder, static_cast<std::uint32_t>(std::max(count - size, 0))));
  }

  template <class Coder>
  std::uint32_t code_gamma(Coder& coder, std::uint32_t value) {
    constexpr std::uint32_t kEven = 32768;
    const std::uint32_t plus = value + 1;
    std::uint32_t bits = 0;
    while (bits < 23 && coder.code((plus >> (bits + 1)) != 0, kEven)) ++bits;
    std::uint32_t result = 1;
    for (std::uint32_t i = bits; i-- > 0;) {
      result = result * 2 + (coder.code(((plus >> i) & 1U) != 0, kEven) ? 1U : 0U);
    }
    return result - 1;
  }

  [[nodiscard]] static std::uint32_t mean_activity(const View& v) {
    std::uint32_t sum = 0;
    std::uint32_t weight = 0;
    const auto add = [&](const Cell* cell, std::uint32_t w) {
      if (cell->range == 0) return;
      sum += cell->activity * w;
      weight += w;
    };
    for (const Cell* cell : {v.a, v.b, v.n}) add(cell, 2);
    for (const Cell* cell : {v.na, v.nb, v.sa, v.sb}) add(cell, 1);
    return weight == 0 ? 10U : kMean[sum * 8U / weight];
  }

  static constexpr std::uint32_t kUnary = 20;
  static constexpr std::int32_t kTypical = 150'000;  // 15 m, where nothing is known yet
  static constexpr auto kScale = [] {
    constexpr std::array<int, 9> kFrom{2, 4, 8, 12, 20, 32, 56, 96, 192};
    std::array<std::uint8_t, 256> table{};
    for (int i = 0; i < 256; ++i) {
      std::uint8_t& level = table[static_cast<std::size_t>(i)];
      for (const int from : kFrom) level = static_cast<std::uint8_t>(level + (i >= from ? 1 : 0));
    }
    return table;
  }();
  // 1 + 3 log2(1 + 4 m) of a mean activity m in eighths, 0 to 15.
  static constexpr auto kMean = [] {
    std::array<std::uint8_t, 161> table{};
    for (int i = 1; i < 161; ++i) {
      int level = 1;
      while (level < 15 && (2 + i) * (2 + i) * (2 + i) >= (8 << level)) ++level;
      table[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(level);
    }
    return table;
  }();

  std::int32_t step_ = 1;
  std::int32_t edge_ = 1;       // a jump in depth, not a slope, 0.1 mm
  std::uint64_t per_step_ = 0;  // eighths of a step per 0.1 mm, 2^-32
  BitMixer<4> group_;
  BitMixer<7> mask_;
  BitMixer<4> pick_;
  BitMixer<4> zero_;
  BitMixer<3> sign_;
  BitMixer<4> magnitude_;
};

}  // namespace sweepcast::beam
