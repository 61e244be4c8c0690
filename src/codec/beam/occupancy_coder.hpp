// Codes which cells hold a point.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "codec/beam/plane.hpp"
#include "codec/entropy/deep_mixer.hpp"
#include "codec/entropy/mixer.hpp"
#include "codec/entropy/symbol_coder.hpp"

namespace sweepcast::beam {

/// The states of a run of cells, and of their neighbours, placed as in `Neighbours`. A neighbour
/// may be a cell of the run itself that comes before.
struct RunStates {
  CellState* cell;
  const CellState *a, *b, *n, *na, *nb, *sa, *sb, *aa, *bb, *nn;
  std::size_t count;
  std::uint32_t step;  ///< number of the step in the lattice
  std::uint32_t row;
};

/// Cells whose states are said at once where they are as expected.
inline constexpr std::size_t kGroup = 8;

/// Codes states. `kInputs` contexts are mixed: 2 or 5, or more deeply 9; 1 stands for symbols in
/// place of bits.
template <std::size_t kInputs>
class OccupancyCoder {
 public:
  void reset() {
    group_.reset();
    cell_.reset();
    halves_.reset(kEven);
    history_ = 0;
  }

  /// Begins a run. Encoding: `truth` has a range for each cell of the run that holds a point, else
  /// 0. Decoding: null.
  void begin(const RunStates& run, const std::int32_t* truth) {
    history_ = 0;
    doubt_.resize(run.count);
    truth_.resize(run.count);
    if (truth == nullptr) return;
    for (std::size_t i = 0; i < run.count; ++i) {
      truth_[i] = truth[i] != 0 ? CellState::measured : CellState::empty;
    }
  }

  /// Guesses the states of cells [first, last) from their neighbours, which must be known.
  void guess(const RunStates& run, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) guess_cell(run, i, doubt_.data());
  }

  /// The same for a run none of whose cells is a neighbour of another: all at once.
  void guess_all(const RunStates& run) {
    const RunStates states = run;
    std::uint8_t* const doubt = doubt_.data();
#pragma GCC ivdep
    for (std::size_t i = 0; i < states.count; ++i) guess_cell(states, i, doubt);
  }

  /// Codes the states of cells [first, last) of a run, at most kGroup, which have been guessed.
  template <class Coder>
  void code_group(Coder& coder, const RunStates& run, std::size_t first, std::size_t last) {
    GroupGuess guess{};
    bool as_expected = true;
    for (std::size_t i = first; i < last; ++i) {
      guess.doubtful += doubt_[i];
      as_expected &= run.cell[i] == truth_[i];
      if constexpr (kIsDeep) {
        guess.measured = guess.measured * 2 + (run.cell[i] == CellState::measured ? 1U : 0U);
        guess.doubts = guess.doubts * 3 + doubt_[i];
      }
    }
    if (group_as_expected(coder, run, guess, as_expected)) return;
    if constexpr (kInputs == 1) {
      for (std::size_t half = first; half < last; half += kHalf) {
        code_half(coder, run, half, std::min(last, half + kHalf));
      }
      return;
    }
    for (std::size_t i = first; i < last; ++i) run.cell[i] = CellState::unknown;
    std::uint32_t wrong = 0;
    for (std::size_t i = first; i < last; ++i) {
      const auto left = static_cast<std::uint32_t>(last - i);
      const bool guessed = ((guess.measured >> (left - 1)) & 1U) != 0;
      const bool occupied =
          code_cell(coder, run, i, left * 16 + wrong, truth_[i] == CellState::measured);
      run.cell[i] = occupied ? CellState::measured : CellState::empty;
      wrong = std::min(wrong + (occupied != guessed ? 1U : 0U), 3U);
    }
  }

 private:
  static constexpr int kTableBits = 13;
  static constexpr bool kIsDeep = kInputs > 5;
  static constexpr std::size_t kPlainInputs = kIsDeep ? 5 : kInputs;
  static constexpr std::size_t kGroupInputs = kInputs > 4 ? 4 : kInputs > 1 ? 2 : 1;
  using Group = std::conditional_t<kIsDeep, DeepMixer<0, kGroupInputs + 4>, BitMixer<kGroupInputs>>;
  using Cell = std::conditional_t<kIsDeep, DeepMixer<0, kInputs>, BitMixer<kInputs>>;

  /// The guesses for a group of cells.
  struct GroupGuess {
    std::uint32_t doubtful = 0;  ///< sum of the doubts
    std::uint32_t measured = 0;  ///< a bit a cell, the last one lowest
    std::uint32_t doubts = 0;    ///< a digit to the base of 3 a cell
  };

  // 0 unknown, 1 empty, 2 holds a point.
  static std::uint8_t known(CellState state) {
    const auto value = static_cast<unsigned>(state);
    return static_cast<std::uint8_t>((value & 2U) | (value & ~(value >> 1) & 1U));
  }

  // What two of a, b and n say, else n, else a side that is known. In masks, not choices, so that
  // loops vectorise.
  [[gnu::always_inline]] static void guess_cell(const RunStates& run, std::size_t i,
                                                std::uint8_t* doubt) {
    const std::uint8_t a = known(run.a[i]);
    const std::uint8_t b = known(run.b[i]);
    const std::uint8_t n = known(run.n[i]);
    const auto side = static_cast<std::uint8_t>(a | (is_zero(a) & (b | (is_zero(b) & 2U))));
    const auto other = static_cast<std::uint8_t>(n | (is_zero(n) & side));
    const auto agreed = static_cast<std::uint8_t>(a | (is_zero(a) & other));
    const std::uint8_t agree = is_zero(static_cast<std::uint8_t>(a ^ b));
    run.cell[i] = static_cast<CellState>((agreed & agree) | (other & ~agree));
    const auto odd =
        static_cast<std::uint8_t>(~is_zero(n) & ~is_zero(static_cast<std::uint8_t>(n ^ a)) & 1U);
    doubt[i] = static_cast<std::uint8_t>((odd & agree) | (2U & ~agree));
  }
  // 255 for 0, else 0; for values below 4.
  [[gnu::always_inline]] static std::uint8_t is_zero(std::uint8_t v) {
    return static_cast<std::uint8_t>(((v | (v >> 1)) & 1U) - 1U);
  }

  template <class Coder>
  bool group_as_expected(Coder& coder, const RunStates& run, const GroupGuess& guess, bool is) {
    const std::uint32_t step = run.step;
    const std::uint32_t doubtful = guess.doubtful;
    const std::uint32_t doubt = std::min(doubtful, 7U);
    typename BitMixer<kGroupInputs>::Contexts contexts;
    contexts[0] = (doubtful * 4U + (history_ & 3U)) * 8U + step;
    if constexpr (kGroupInputs > 1) {
      contexts[1] = doubt * 16U + (history_ & 15U);
    }
    if constexpr (kGroupInputs > 2) {
      contexts[2] = (history_ & 255U) * 4U + doubt / 2U;
      contexts[3] = doubt * 8U + step;
    }
    bool same = false;
    if constexpr (kIsDeep) {
      same = group_.code(coder,
                         {{},
                          {contexts[0], contexts[1], contexts[2], contexts[3],
                           hash_context(guess.measured, guess.doubts),
                           hash_context(guess.doubts, 5000 + (history_ & 1U)),
                           hash_context(run.row, doubt), hash_context(guess.measured, 777 + doubt)},
                          doubt,
                          history_ & 15U,
                          doubtful * 4 + (history_ & 3U)},
                         is);
    } else {
      same = group_.code(coder, contexts, doubt, is);
    }
    history_ = history_ * 2U + (same ? 1U : 0U);
    return same;
  }

  // Which of four cells are not as guessed, as one symbol.
  template <class Coder>
  void code_half(Coder& coder, const RunStates& run, std::size_t first, std::size_t last) {
    std::uint32_t guessed = 0;
    std::uint32_t doubted = 0;
    std::uint32_t wrong = 0;
    for (std::size_t i = first; i < last; ++i) {
      const auto at = static_cast<std::uint32_t>(i - first);
      guessed |= (run.cell[i] == CellState::measured ? 1U : 0U) << at;
      doubted |= (doubt_[i] > 0 ? 1U : 0U) << at;
      wrong |= (run.cell[i] != truth_[i] ? 1U : 0U) << at;
    }
    wrong = halves_.code(coder, guessed * 16U + doubted, wrong);
    for (std::size_t i = first; i < last; ++i) {
      const bool occupied = (((guessed ^ wrong) >> (i - first)) & 1U) != 0;
      run.cell[i] = occupied ? CellState::measured : CellState::empty;
    }
  }

  // `place`: how many cells of the group are left, and how many of those before were not as
  // guessed.
  template <class Coder>
  bool code_cell(Coder& coder, const RunStates& run, std::size_t i, std::uint32_t place,
                 bool occupied) {
    const std::uint32_t n = known(run.n[i]);
    const std::uint32_t sa = known(run.sa[i]);
    const std::uint32_t sides = known(run.a[i]) * 3U + known(run.b[i]);
    const std::uint32_t near = ((sides * 3U + n) * 3U + sa) * 3U + known(run.sb[i]);
    const std::uint32_t step = run.step;
    const std::uint32_t before = i > 0 ? known(run.cell[i - 1]) : 0U;
    typename BitMixer<kPlainInputs>::Contexts contexts;
    contexts[0] = (near * 3U + before) * 8U + step;
    if constexpr (kInputs > 1) {
      contexts[1] = hash_context((run.row * 9U + sides) * 3U + before, n);
    }
    if constexpr (kInputs > 2) {
      const std::uint32_t across = known(run.na[i]) * 3U + known(run.nb[i]);
      const std::uint32_t beyond = known(run.aa[i]) * 3U + known(run.bb[i]);
      const std::uint32_t nn = known(run.nn[i]);
      contexts[2] = hash_context(near * 27U + across * 3U + nn, step);
      contexts[3] = ((sides * 9U + beyond) * 3U + n) * 8U + step;
      contexts[4] = hash_context((sides * 9U + across) * 9U + n * 3U + nn, step);
    }
    const std::size_t set = sides * 9U + n * 3U + sa;
    if constexpr (kIsDeep) {
      const auto here = static_cast<std::ptrdiff_t>(i);
      const std::uint32_t row = (known(run.n[here - 1]) * 3U + n) * 3U + known(run.n[here + 1]);
      const std::uint32_t two = before * 3 + (i > 1 ? known(run.cell[i - 2]) : 0U);
      return cell_.code(
          coder,
          {{},
           {contexts[0], contexts[1], contexts[2], contexts[3], contexts[4],
            hash_context((row * 3U + before) * 9U + sides, 4000), hash_context(two, near + 6000),
            hash_context(run.row, near + 8000), hash_context(place, 9000 + sides * 3U + n)},
           set,
           two,
           near},
          occupied);
    } else {
      return cell_.code(coder, contexts, set, occupied);
    }
  }

  static constexpr std::size_t kHalf = 4;
  // Nothing is known of the shares.
  static constexpr SymbolShares kEven = [] {
    SymbolShares shares{};
    for (std::size_t k = 0; k < kSymbols; ++k) {
      shares.from[k] = static_cast<std::int16_t>(k << (kShareBits - 4));
    }
    return shares;
  }();

  SymbolCoder halves_{256};
  Group group_ = [] {
    if constexpr (kIsDeep) {
      return Group(kTableBits, 8, 16, 68);
    } else {
      return Group(kTableBits, 8);
    }
  }();
  Cell cell_ = [] {
    if constexpr (kIsDeep) {
      return Cell(kTableBits + 1, 81, 9, 243);
    } else {
      return Cell(kTableBits, 81);
    }
  }();
  std::uint32_t history_ = 0;
  std::vector<std::uint8_t> doubt_;  ///< of a run's guesses: 0 sure, 1, 2
  std::vector<CellState> truth_;     ///< of a run; decoding: anything
};

}  // namespace sweepcast::beam
