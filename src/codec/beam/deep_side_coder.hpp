// Codes on which side of a jump in depth a cell lies, for the fewest bytes.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "codec/beam/offset_estimator.hpp"
#include "codec/beam/prediction.hpp"
#include "codec/entropy/deep_mixer.hpp"
#include "codec/entropy/mixer.hpp"

namespace sweepcast::beam {

/// What a cell at a jump in depth between a and b belongs to.
enum class Side : std::uint8_t { none, a, b };

/// Codes sides under contexts that sort every neighbour by the side to which it belongs.
class DeepSideCoder {
 public:
  static constexpr std::size_t kPlain = 4;

  void reset() {
    mixer_.reset();
    history_ = 0;
  }

  /// Codes the side of a cell; `plain` has the contexts that simpler coders have. Decoding: the
  /// last argument is not used.
  template <class Coder>
  Side code(Coder& coder, const CellView& cell, const std::array<std::uint32_t, kPlain>& plain,
            Side side) {
    const std::size_t rising = cell.at(Neighbours::a) < cell.at(Neighbours::b) ? 1 : 0;
    const std::size_t curve = plain[0] / 8;
    Mixer::Bit at{{}, contexts(cell, plain), rising, history_ & 15U, curve};
    if (!mixer_.code(coder, at, side != Side::none)) {
      history_ *= 4;
      return Side::none;
    }
    for (std::uint32_t& context : at.contexts) context += kSecond;
    at.first_set += 2;
    at.second_set += 16;
    at.correction += kCurves;
    const bool is_b = mixer_.code(coder, at, side == Side::b);
    history_ = history_ * 4 + (is_b ? 2 : 1);
    return is_b ? Side::b : Side::a;
  }

 private:
  static constexpr std::size_t kContexts = 10;
  static constexpr std::uint32_t kSecond = 0x2345;
  static constexpr std::size_t kCurves = 56;
  using Mixer = DeepMixer<0, kContexts>;

  // 0 not known; 1 at a's depth, 2 at b's, 4 at both; 3 between them; 5 beyond a, 6 beyond b.
  static std::uint32_t sort(const CellView& cell, std::int32_t range) {
    const std::int32_t a = cell.at(Neighbours::a);
    const std::int32_t b = cell.at(Neighbours::b);
    if (range == 0) return 0;
    const bool at_a = std::abs(range - a) < cell.scale.edge;
    const bool at_b = std::abs(range - b) < cell.scale.edge;
    if (at_a || at_b) return (at_a ? 1U : 0U) + (at_b ? 2U : 0U) + (at_a && at_b ? 1U : 0U);
    if ((range < a) != (range < b)) return 3;
    return (range < a) == (a < b) ? 5 : 6;
  }

  std::array<std::uint32_t, kContexts> contexts(
      const CellView& cell, const std::array<std::uint32_t, kPlain>& plain) const {
    using N = Neighbours;
    const auto sorted = [&](N::Place place) { return sort(cell, cell.at(place)); };
    const std::int32_t a = cell.at(N::a);
    const std::int32_t b = cell.at(N::b);
    const std::uint32_t rising = a < b ? 1 : 0;
    const auto jump = static_cast<std::uint32_t>(
        std::bit_width(static_cast<std::uint32_t>(std::abs(a - b) / cell.scale.edge)));
    const auto depth = static_cast<std::uint32_t>(
        std::bit_width(static_cast<std::uint32_t>(std::min(a, b)) >> 12));
    const std::uint32_t n = sorted(N::n);
    const std::uint32_t above = (n * 7 + sorted(N::na)) * 7 + sorted(N::nb);
    const std::uint32_t below = sorted(N::sa) * 7 + sorted(N::sb);
    const std::uint32_t left = sort(cell, cell.at(N::n, -1));
    const std::uint32_t right = sort(cell, cell.at(N::n, 1));
    const std::uint32_t before = sort(cell, cell.i > 0 ? cell.self[-1] : 0);
    return {plain[0],
            plain[1],
            plain[2],
            plain[3],
            hash_context(above, below * 2 + rising),
            hash_context((n * 7 + sorted(N::nn)) * 7 + left, (right * 7 + rising) * 7 + 100),
            hash_context((sorted(N::aa) * 7 + sorted(N::bb)) * 7 + before, n * 7 + 200 + rising),
            hash_context(cell.row, rising * 8 + n + 300),
            hash_context(depth * 16 + jump, n * 2 + rising + 400),
            hash_context(history_ & 63U, above * 2 + rising)};
  }

  std::uint32_t history_ = 0;  ///< the last sides, 2 bits each
  Mixer mixer_{12, 4, 32, 2 * kCurves};
};

}  // namespace sweepcast::beam
