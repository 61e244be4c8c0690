// Codes the cells that one step of the lattice adds, a run at a time: which hold a point, on which
// side of a jump in depth they lie, and by how many steps their ranges miss the prediction.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <type_traits>

#include "codec/beam/deep_residual_coder.hpp"
#include "codec/beam/deep_side_coder.hpp"
#include "codec/beam/occupancy_coder.hpp"
#include "codec/beam/prediction.hpp"
#include "codec/beam/quick_residual_coder.hpp"
#include "codec/beam/residual_coder.hpp"
#include "codec/entropy/mixer.hpp"
#include "codec/entropy/range_coder.hpp"

namespace sweepcast::beam {

/// Cells in a row of a plane, one after the other, with their neighbours.
struct Run {
  Neighbours neighbours;
  RunStates states;
  std::int32_t* range;     ///< of the first cell
  std::uint8_t* activity;  ///< of the first cell
  /// Whether a cell's neighbours may be cells before it in this run.
  bool sequential = false;
};

/// In the place of a number of contexts: the coders that take the fewest bytes.
inline constexpr std::size_t kDeep = 8;

/// Codes runs. So many contexts are mixed for residuals and for states; 1 stands for symbols in
/// place of bits, kDeep for deep mixing.
template <std::size_t kResidualInputs, std::size_t kStateInputs>
class StepCoder {
 public:
  /// Begins an image: forgets what was learnt.
  void reset() {
    occupancy_.reset();
    residual_.reset();
    pick_.reset();
    deep_side_.reset();
    side_.reset(kFirstSides);
    skip_.reset();
  }

  /// Begins a step of the lattice. `step` is that of ranges, 0.1 mm. `tolerance`: groups of cells
  /// that interpolation gets as near as that may be left out, 0.1 mm; negative: none are.
  void begin_step(std::int32_t step, std::int32_t tolerance, const Stages& stages) {
    stages_ = stages;
    scale_ = PredictionScale(step);
    steps_per_unit_ = 1.0 / step;
    tolerance_ = tolerance;
    residual_.soften();
  }

  /// Codes a run. Encoding: `truth` has the cells' ranges, 0 where there is no point. Decoding:
  /// null.
  template <class Coder>
  void code(Coder& coder, const Run& run, const std::int32_t* truth) {
    const std::size_t count = run.states.count;
    predictions_.resize(count);
    contexts_.resize(count);
    occupancy_.begin(run.states, truth);
    skipped_ = 0;
    if (!run.sequential) {
      predict(run.neighbours, scale_, count, predictions_);
      simplify(run, 0, count);
      occupancy_.guess_all(run.states);
    }
    for (std::size_t first = 0; first < count; first += kGroup) {
      if (ran_dry(coder)) return;
      const std::size_t last = std::min(count, first + kGroup);
      if (tolerance_ >= 0 && skip_group(coder, run, first, last, truth)) continue;
      if (run.sequential) occupancy_.guess(run.states, first, last);
      occupancy_.code_group(coder, run.states, first, last);
    }
    if constexpr (kIsDeep) residual_.begin_run();
    if (run.sequential) {
      code_ranges_in_turn(coder, run, truth);
    } else {
      code_ranges(coder, run, truth);
    }
  }

 private:
  static constexpr std::size_t kPicks = kResidualInputs > 3 ? 4 : kResidualInputs > 1 ? 2 : 1;
  static constexpr bool kAllContexts = kResidualInputs > 1;
  static constexpr bool kIsDeep = kResidualInputs == kDeep;
  using Pick = BitMixer<kPicks>;

  /// Where a coder is not the one that is used.
  struct Unused {
    void reset() {}
  };

  [[nodiscard]] CellView view(const Run& run, std::size_t i) const {
    return {run.neighbours, scale_,         predictions_,    i,
            run.range + i,  run.sequential, run.states.step, run.states.row};
  }

  // Predictions of cells [first, last), which are one or all.
  void simplify(const Run& run, std::size_t first, std::size_t last) {
    for (std::size_t i = first; !stages_.prediction && i < last; ++i) {
      const std::int32_t before = run.neighbours.range[Neighbours::a][i];
      if (before > 0) predictions_.range[i] = before;
      predictions_.carried[i] = 0;
      predictions_.basis[i] = static_cast<std::int32_t>(before > 0 ? Basis::one : Basis::guess);
    }
  }

  // The ranges of a run none of whose cells is a neighbour of another, which have been predicted.
  template <class Coder>
  void code_ranges(Coder& coder, const Run& run, const std::int32_t* truth) {
    const std::size_t count = run.states.count;
    const CellState* state = run.states.cell;
    for (std::size_t i = 0; i < count; ++i) {
      if (!may_have_side(run, i)) continue;
      if (ran_dry(coder)) return;
      pick_side(coder, run, i, truth == nullptr ? 0 : truth[i]);
    }
    describe(run.neighbours, scale_, predictions_, count, kAllContexts, contexts_);
    for (std::size_t i = 0; i < count; ++i) {
      if (state[i] != CellState::measured) continue;
      if (ran_dry(coder)) return;
      code_range(coder, run, i, truth == nullptr ? 0 : truth[i]);
    }
  }

  // The same of a run whose cells are neighbours of those after them.
  template <class Coder>
  void code_ranges_in_turn(Coder& coder, const Run& run, const std::int32_t* truth) {
    for (std::size_t i = 0; i < run.states.count; ++i) {
      if (run.states.cell[i] != CellState::measured) continue;
      if (ran_dry(coder)) return;
      const std::int32_t range = truth == nullptr ? 0 : truth[i];
      predict_one(run.neighbours, scale_, i, predictions_);
      simplify(run, i, i + 1);
      if (may_have_side(run, i)) pick_side(coder, run, i, range);
      describe_one(run.neighbours, scale_, predictions_, i, kAllContexts, contexts_);
      code_range(coder, run, i, range);
    }
  }

  [[nodiscard]] bool may_have_side(const Run& run, std::size_t i) const {
    return stages_.edges && run.states.cell[i] == CellState::measured &&
           predictions_.basis[i] == static_cast<std::int32_t>(Basis::gap);
  }

  template <class Coder>
  void code_range(Coder& coder, const Run& run, std::size_t i, std::int32_t range) {
    const std::int32_t predicted = predictions_.range[i];
    const std::int32_t wanted = kDecodes<Coder> ? 0 : in_steps(range - predicted);
    std::int32_t steps = 0;
    if constexpr (kIsDeep) {
      steps = residual_.code(coder, view(run, i), contexts_, wanted);
    } else {
      steps = residual_.code(coder, contexts_, i, predictions_.basis[i], wanted);
    }
    const std::int64_t decoded = predicted + std::int64_t{steps} * scale_.step;
    run.range[i] =
        static_cast<std::int32_t>(std::clamp<std::int64_t>(decoded, kNearest, kFarthest));
    run.activity[i] = static_cast<std::uint8_t>(std::min(std::abs(steps), 20));
  }

  [[nodiscard]] std::int32_t in_steps(std::int32_t difference) const {
    // The quotient's floor, exactly, for half a unit keeps it clear of whole numbers.
    const std::int32_t shifted = std::abs(difference) + scale_.step / 2;
    const auto size = static_cast<std::int32_t>((shifted + 0.5) * steps_per_unit_);
    return difference < 0 ? -size : size;
  }

  // Whether a group is left out. Its cells then get the ranges of `fill_of`.
  template <class Coder>
  bool skip_group(Coder& coder, const Run& run, std::size_t first, std::size_t last,
                  const std::int32_t* truth) {
    std::uint32_t gaps = 0;
    std::uint32_t activity = 0;
    bool near = true;
    for (std::size_t i = first; i < last; ++i) {
      gaps += predictions_.basis[i] == 0 ? 0U : 1U;
      activity += run.neighbours.activity[Neighbours::a][i];
      if (truth != nullptr) near = near && is_near(run, i, truth[i]);
    }
    const std::uint32_t active = std::min<std::uint32_t>(std::bit_width(activity), 7U);
    const BitMixer<3>::Contexts contexts{(gaps * 8U + active) * 4U + (skipped_ & 3U),
                                         (active * 8U + run.states.step) * 16U + (skipped_ & 15U),
                                         gaps * 8U + run.states.step};
    const bool skip = skip_.code(coder, contexts, std::min(gaps, 7U), near);
    skipped_ = skipped_ * 2U + (skip ? 1U : 0U);
    for (std::size_t i = first; skip && i < last; ++i) {
      const std::int32_t fill = fill_of(run, i);
      // Only between two sides is a range sure enough to be shown.
      const bool sure = predictions_.basis[i] == static_cast<std::int32_t>(Basis::between);
      const CellState full = sure ? CellState::filled : CellState::assumed;
      run.states.cell[i] = fill == 0 ? CellState::empty : full;
      if (fill == 0) continue;
      run.range[i] = std::clamp(fill, kNearest, kFarthest);
      run.activity[i] = 1;
    }
    return skip;
  }

  // The range that a cell gets where its group is left out, 0 for none: a cell must still have the
  // state that was guessed for it.
  [[nodiscard]] std::int32_t fill_of(const Run& run, std::size_t i) const {
    if (run.states.cell[i] == CellState::empty) return 0;
    const auto at = [&](Neighbours::Place place) { return run.neighbours.range[place][i]; };
    const auto basis = static_cast<Basis>(predictions_.basis[i]);
    if (basis == Basis::between || basis == Basis::one) return predictions_.range[i];
    if (basis != Basis::gap) return 0;
    const std::int32_t n = at(Neighbours::n);
    const std::int32_t a = at(Neighbours::a);
    const std::int32_t b = at(Neighbours::b);
    if (n == 0) return std::min(a, b);
    return std::abs(n - a) < std::abs(n - b) ? a : b;
  }

  // Whether a point is not missed where its cell is left out.
  [[nodiscard]] bool is_near(const Run& run, std::size_t i, std::int32_t range) const {
    if (range == 0) return true;
    const auto within = [&](std::int32_t other) {
      return other > 0 && std::abs(range - other) <= tolerance_;
    };
    const std::int32_t fill = fill_of(run, i);
    const bool sure = predictions_.basis[i] == static_cast<std::int32_t>(Basis::between);
    if (within(fill) || (sure && fill > 0)) return within(fill);
    return within(run.neighbours.range[Neighbours::a][i]) ||
           within(run.neighbours.range[Neighbours::b][i]);
  }

  // A jump in depth between both sides: the encoder says which side the cell belongs to.
  template <class Coder>
  void pick_side(Coder& coder, const Run& run, std::size_t i, std::int32_t range) {
    const auto at = [&](Neighbours::Place place) { return run.neighbours.range[place][i]; };
    const std::int32_t a = at(Neighbours::a);
    const std::int32_t b = at(Neighbours::b);
    const std::int32_t between = predictions_.range[i];
    const auto apart = [](std::int32_t u, std::int32_t v) { return std::abs(u - v); };
    const std::uint32_t rising = a < b ? 1U : 0U;
    const std::uint32_t step = run.states.step;
    const std::uint32_t across = side_across(run, i);
    const std::uint32_t below = below_goes_on(run, i);
    const std::uint32_t goes_on =
        (at(Neighbours::aa) > 0 && apart(at(Neighbours::aa), a) < scale_.edge ? 1U : 0U) +
        (at(Neighbours::bb) > 0 && apart(at(Neighbours::bb), b) < scale_.edge ? 2U : 0U);
    const auto jump = static_cast<std::uint32_t>(
        std::bit_width(static_cast<std::uint32_t>(apart(a, b) / scale_.edge)));
    typename Pick::Contexts contexts;
    contexts[0] = ((across * 8U + below) * 4U + goes_on) * 2U + rising;
    if constexpr (kPicks > 1) {
      contexts[1] = jump * 8U + across;
    }
    if constexpr (kPicks > 2) {
      contexts[2] = (across * 4U + goes_on) * 2U + rising;
      contexts[3] = (across * 8U + below) * 8U + step;
    }
    const bool is_side = apart(range, between) > std::min(apart(range, a), apart(range, b));
    const Side wanted = !is_side                            ? Side::none
                        : apart(range, b) < apart(range, a) ? Side::b
                                                            : Side::a;
    Side side = Side::none;
    if constexpr (kIsDeep) {
      side = deep_side_.code(coder, view(run, i), contexts, wanted);
    } else {
      side = code_side(coder, contexts, rising, wanted);
    }
    if (side == Side::none) return;
    predictions_.range[i] = side == Side::b ? b : a;
    predictions_.spread[i] = scale_.edge;
    predictions_.basis[i] = static_cast<std::int32_t>(Basis::side);
  }

  template <class Coder>
  Side code_side(Coder& coder, const typename Pick::Contexts& contexts, std::uint32_t rising,
                 Side side) {
    if constexpr (kPicks == 1) {
      const std::uint32_t symbol = side_.code(coder, contexts[0], static_cast<std::uint32_t>(side));
      return symbol > 2 ? Side::none : static_cast<Side>(symbol);
    }
    if (!pick_.code(coder, contexts, rising, side != Side::none)) return Side::none;
    typename Pick::Contexts second = contexts;
    for (std::uint32_t& context : second) context += 512U;
    return pick_.code(coder, second, 2U + rising, side == Side::b) ? Side::b : Side::a;
  }

  // On which side of the jump the cell across lies: 0 and 1 where the jump is there too, 2 where
  // there is another, 3 where there is none or nothing, 4 to 6 by its range alone.
  [[nodiscard]] std::uint32_t side_across(const Run& run, std::size_t i) const {
    const auto at = [&](Neighbours::Place place) { return run.neighbours.range[place][i]; };
    const std::int32_t n = at(Neighbours::n);
    if (n == 0) return 3;
    const bool corners = at(Neighbours::na) > 0 && at(Neighbours::nb) > 0;
    const std::int32_t a = at(corners ? Neighbours::na : Neighbours::a);
    const std::int32_t b = at(corners ? Neighbours::nb : Neighbours::b);
    if (corners && std::abs(a - b) < scale_.edge) return 3;
    const std::uint32_t base = corners ? 0 : 4;
    const std::int32_t to_a = std::abs(n - a);
    const std::int32_t to_b = std::abs(n - b);
    if (to_a < to_b) return base + (to_a < scale_.edge ? 0U : 2U);
    return base + (to_b < scale_.edge ? 1U : 2U);
  }

  // Whether both sides go on below: a bit for each, or 4 and a bit for each that is known.
  [[nodiscard]] std::uint32_t below_goes_on(const Run& run, std::size_t i) const {
    const auto at = [&](Neighbours::Place place) { return run.neighbours.range[place][i]; };
    const std::int32_t sa = at(Neighbours::sa);
    const std::int32_t sb = at(Neighbours::sb);
    if (sa == 0 || sb == 0) return 4U + (sa > 0 ? 1U : 0U) + (sb > 0 ? 2U : 0U);
    return (std::abs(sa - at(Neighbours::a)) < scale_.edge ? 1U : 0U) +
           (std::abs(sb - at(Neighbours::b)) < scale_.edge ? 2U : 0U);
  }

  Stages stages_;
  PredictionScale scale_;
  double steps_per_unit_ = 1.0;
  std::int32_t tolerance_ = -1;
  std::uint32_t skipped_ = 0;  // the last groups: whether they were left out
  Predictions predictions_;
  Contexts contexts_;
  OccupancyCoder<kStateInputs> occupancy_;
  using PlainResidualCoder = std::conditional_t<kResidualInputs == 1, QuickResidualCoder,
                                                ResidualCoder<kIsDeep ? 4 : kResidualInputs>>;
  std::conditional_t<kIsDeep, DeepResidualCoder, PlainResidualCoder> residual_;
  std::conditional_t<kIsDeep, DeepSideCoder, Unused> deep_side_;
  static constexpr SymbolShares kFirstSides = [] {
    SymbolShares shares{};
    for (std::size_t k = 1; k < kSymbols; ++k) {
      shares.from[k] = static_cast<std::int16_t>(
          k < 4 ? static_cast<int>(k) * 10'800 : (1 << kShareBits) - 16 * static_cast<int>(16 - k));
    }
    return shares;
  }();
  SymbolCoder side_{448};
  Pick pick_{10, 4};
  BitMixer<3> skip_{10, 8};
};

}  // namespace sweepcast::beam
