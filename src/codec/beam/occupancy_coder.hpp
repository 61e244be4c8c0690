// Codes which cells hold a point.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/beam/plane.hpp"
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

/// Codes states. `kInputs` contexts are mixed: 2 or 5; 1 stands for symbols in place of bits.
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
    std::uint32_t doubtful = 0;
    bool as_expected = true;
    for (std::size_t i = first; i < last; ++i) {
      doubtful += doubt_[i];
      as_expected &= run.cell[i] == truth_[i];
    }
    if (group_as_expected(coder, run.step, doubtful, as_expected)) return;
    if constexpr (kInputs == 1) {
      for (std::size_t half = first; half < last; half += kHalf) {
        code_half(coder, run, half, std::min(last, half + kHalf));
      }
      return;
    }
    for (std::size_t i = first; i < last; ++i) run.cell[i] = CellState::unknown;
    for (std::size_t i = first; i < last; ++i) {
      const bool occupied = code_cell(coder, run, i, truth_[i] == CellState::measured);
      run.cell[i] = occupied ? CellState::measured : CellState::empty;
    }
  }

 private:
  static constexpr int kTableBits = 13;
  static constexpr std::size_t kGroupInputs = kInputs > 4 ? 4 : kInputs > 1 ? 2 : 1;

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
  bool group_as_expected(Coder& coder, std::uint32_t step, std::uint32_t doubtful, bool is) {
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
    const bool same = group_.code(coder, contexts, doubt, is);
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

  template <class Coder>
  bool code_cell(Coder& coder, const RunStates& run, std::size_t i, bool occupied) {
    const std::uint32_t n = known(run.n[i]);
    const std::uint32_t sa = known(run.sa[i]);
    const std::uint32_t sides = known(run.a[i]) * 3U + known(run.b[i]);
    const std::uint32_t near = ((sides * 3U + n) * 3U + sa) * 3U + known(run.sb[i]);
    const std::uint32_t step = run.step;
    const std::uint32_t before = i > 0 ? known(run.cell[i - 1]) : 0U;
    typename BitMixer<kInputs>::Contexts contexts;
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
    return cell_.code(coder, contexts, sides * 9U + n * 3U + sa, occupied);
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
  BitMixer<kGroupInputs> group_{kTableBits, 8};
  BitMixer<kInputs> cell_{kTableBits, 81};
  std::uint32_t history_ = 0;
  std::vector<std::uint8_t> doubt_;  ///< of a run's guesses: 0 sure, 1, 2
  std::vector<CellState> truth_;     ///< of a run; decoding: anything
};

}  // namespace sweepcast::beam
