// Codes by how many steps a range is off its prediction, for the fewest bytes.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "codec/beam/error_spread.hpp"
#include "codec/beam/offset_estimator.hpp"
#include "codec/beam/prediction.hpp"
#include "codec/beam/residual_coder.hpp"
#include "codec/entropy/deep_mixer.hpp"
#include "codec/entropy/mixer.hpp"

namespace sweepcast::beam {

/// The thorough twin of ResidualCoder: beside contexts it mixes what the sizes of errors under
/// several contexts let expect, about an offset that an adaptive filter estimates.
class DeepResidualCoder {
 public:
  /// Forgets everything.
  void reset() {
    offsets_.reset();
    spreads_.reset();
    zero_.reset();
    sign_.reset();
    size_.reset();
  }
  /// Keeps what was learnt as a first guess for cells of another kind.
  void soften() {
    spreads_.soften(kSoftSpread);
    zero_.soften(kSoft);
    sign_.soften(kSoft);
    size_.soften(kSoft);
  }
  /// Begins a run.
  void begin_run() { last_ = {}; }

  /// Codes `steps` for a cell. Decoding: the argument is not used.
  template <class Coder>
  std::int32_t code(Coder& coder, const CellView& cell, const Contexts& contexts,
                    std::int32_t steps) {
    const std::int32_t offset = offsets_.estimate(cell);
    const Around at = look_around(cell, contexts, offset);
    std::int32_t coded = 0;
    if (code_nonzero(coder, at, steps != 0)) {
      const bool negative = code_negative(coder, at, steps < 0);
      const std::int32_t size = code_size(coder, at, negative, std::abs(steps));
      coded = negative ? -size : size;
    }
    const std::int32_t error = std::clamp(coded, -100, 100) * 16 - offset;
    offsets_.learn(error);
    spreads_.learn(std::abs(error) * 16);
    last_ = {coded, last_[0], last_[1]};
    return coded;
  }

 private:
  static constexpr std::size_t kSpreads = 4;
  static constexpr std::size_t kContexts = 6;
  static constexpr int kTableBits = 14;
  static constexpr std::int32_t kUnary = 20;
  static constexpr std::uint16_t kSoft = 20;
  static constexpr std::int32_t kSoftSpread = 12;
  using Mixer = DeepMixer<kSpreads, kContexts>;

  /// What a cell's decisions have in common.
  struct Around {
    std::uint32_t trust, slope, sides, distance, direction;  ///< as in Contexts
    std::uint32_t mean;                                      ///< activity nearby, 0 to 15
    std::uint32_t basis;                                     ///< as Basis
    std::uint32_t step;                                      ///< of the lattice
    std::uint32_t row;
    std::uint32_t recent;  ///< how far off the cells before in the run were, 0 to 11
    std::uint32_t bends;   ///< how far off interpolation was beside the cell, 0 to 9
    std::uint32_t before;  ///< how far off each of the three cells before was, below 512
    std::uint32_t offset;  ///< estimated, by its size and sign
  };

  static std::uint32_t width(std::int32_t v) {
    return static_cast<std::uint32_t>(std::bit_width(static_cast<std::uint32_t>(std::abs(v))));
  }
  static std::uint32_t signed_width(std::int32_t v) { return 2 * width(v) + (v < 0 ? 1U : 0U); }

  Around look_around(const CellView& cell, const Contexts& contexts, std::int32_t offset) {
    const auto of = [&](Contexts::Which which) {
      return static_cast<std::uint32_t>(contexts.of[which][cell.i]);
    };
    const auto short_width = [](std::int32_t v) { return std::min(width(v), 7U); };
    const OffsetEstimator::Signs& signs = offsets_.signs();
    Around at{};
    at.trust = of(Contexts::trust);
    at.slope = of(Contexts::slope);
    at.sides = of(Contexts::sides);
    at.distance = of(Contexts::distance);
    at.direction = of(Contexts::direction);
    at.mean = static_cast<std::uint32_t>(contexts.mean[cell.i]);
    at.basis = static_cast<std::uint32_t>(cell.predictions.basis[cell.i]);
    at.step = cell.step;
    at.row = cell.row;
    at.recent =
        std::min(width(2 * std::abs(last_[0]) + std::abs(last_[1]) + std::abs(last_[2])), 11U);
    at.bends = std::min(width((2 * std::abs(signs[0]) + std::abs(signs[1]) + std::abs(signs[3]) +
                               std::abs(signs[4])) /
                              2),
                        9U);
    at.before = (short_width(last_[0]) * 8 + short_width(last_[1])) * 8 + short_width(last_[2]);
    at.offset = signed_width(offset / 2);

    // The mean activity in steps is about (2^(mean / 3) - 1) / 4; half a cell is 4/16 off on
    // average.
    const std::int32_t first = 64 + 64 * ((1 << (at.mean / 3)) - 1);
    spreads_.look_up({at.trust, hash_context(at.mean * 16 + at.recent, at.basis * 16 + at.bends),
                      hash_context(at.row * 6 + at.basis, 999 + at.mean / 3),
                      hash_context(at.trust / 16 * 16 + at.bends, 77)},
                     offset, first);
    return at;
  }

  template <class Expect>
  [[nodiscard]] std::array<std::int32_t, kSpreads> given(Expect expect) const {
    std::array<std::int32_t, kSpreads> expected;
    for (std::size_t k = 0; k < kSpreads; ++k) expected[k] = expect(spreads_[k]);
    return expected;
  }

  template <class Coder>
  bool code_nonzero(Coder& coder, const Around& at, bool is) {
    return zero_.code(coder,
                      {given([](const LogisticErrors& errors) { return errors.nonzero(); }),
                       {at.trust, at.slope, at.sides, at.distance,
                        hash_context(at.before, at.basis * 16 + at.mean),
                        hash_context(at.row * 16 + at.mean, at.basis)},
                       at.basis * 8 + at.mean / 2,
                       at.step * 16 + at.recent,
                       at.bends * 16 + at.mean},
                      is);
  }

  template <class Coder>
  bool code_negative(Coder& coder, const Around& at, bool is) {
    const OffsetEstimator::Signs& signs = offsets_.signs();
    const auto sign = [&](std::size_t k) { return signed_width(signs[k]); };
    return sign_.code(
        coder,
        {given([](const LogisticErrors& errors) { return errors.negative(); }),
         {at.direction, at.slope / 11, hash_context(at.offset, at.basis * 64 + at.recent),
          hash_context(signed_width(last_[0]) * 64 + signed_width(last_[1]),
                       at.basis * 32 + sign(0)),
          hash_context(sign(3) * 32 + sign(4), sign(0)),
          hash_context(sign(8) * 32 + sign(5), sign(6))},
         at.basis,
         at.step * 32 + at.offset,
         at.offset * 8 + at.basis},
        is);
  }

  // At least 1: in unary while small, then by the Elias-gamma code.
  template <class Coder>
  std::int32_t code_size(Coder& coder, const Around& at, bool negative, std::int32_t wanted) {
    const std::uint32_t turned = negative ? 1 : 0;
    const std::int32_t sign = negative ? -1 : 1;
    std::int32_t size = 1;
    for (std::uint32_t i = 0; i < kUnary; ++i) {
      const bool more =
          size_.code(coder,
                     {given([&](const LogisticErrors& errors) { return errors.more(size, sign); }),
                      {i * 16 + at.mean, at.sides + i * 5'003 + turned * 7'919,
                       hash_context(at.trust, i), hash_context(at.slope / 11, i * 2 + turned),
                       hash_context(at.before, i * 8 + at.basis), hash_context(at.distance, i)},
                      i,
                      std::min(i, 7U) * 16 + at.recent,
                      i * 16 + at.mean},
                     wanted > size);
      if (!more) return size;
      ++size;
    }
    return size + static_cast<std::int32_t>(
                      code_gamma(coder, static_cast<std::uint32_t>(std::max(wanted - size, 0))));
  }

  OffsetEstimator offsets_;
  ErrorSpreads<kSpreads> spreads_;
  std::array<std::int32_t, 3> last_{};  ///< steps of the cells before in the run, the last first
  Mixer zero_{kTableBits, 48, 256, 160};
  Mixer sign_{kTableBits, 6, 512, 256};
  Mixer size_{kTableBits, kUnary, 128, std::size_t{kUnary} * 16};
};

}  // namespace sweepcast::beam
