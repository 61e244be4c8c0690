// Codes intensities as integers of up to 16 bits, from the intensities around them: by how far they
// are off an estimate.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "codec/beam/intensity_estimator.hpp"
#include "codec/entropy/mixer.hpp"

namespace sweepcast::beam {

/// Says on which side of an estimate a value lies and how far off: in unary, by buckets as wide as
/// errors are large, then the place in the bucket. That takes little more decisions than there are
/// bits of information. `kInputs` contexts are mixed: 1 is fast, 2 are small. Integer arithmetic
/// throughout; one function serves both directions.
template <std::size_t kInputs>
class IntensityCoder {
 public:
  /// Begins a sweep of `rows` rows of values of `bits` bits; forgets what was learnt.
  void begin(int rows, int bits) {
    bits_ = bits;
    side_.reset();
    bucket_.reset();
    place_.reset();
    estimator_.begin(rows, bits);
  }

  /// Codes one value; `set` and `row` are the estimator's. Decoding, `truth` is not used.
  template <class Coder>
  std::int32_t code(Coder& coder, const IntensityNeighbours& near, std::size_t set, std::size_t row,
                    std::int32_t truth) {
    const auto estimate = estimator_.estimate(near, set, row);
    const Around around = describe(near, estimate);
    const std::int32_t most = (1 << bits_) - 1;
    const std::int32_t centre = std::min(most, (estimate.value + kOne / 2) / kOne);
    const bool up = centre == 0 || side_.code(coder, contexts(around, around.fraction, 0, centre),
                                              around.width, truth >= centre);
    const std::int32_t sign = up ? 1 : -1;
    const std::int32_t first = up ? centre : centre - 1;  // what is nearest on this side
    const std::int32_t limit = up ? most - centre : centre - 1;
    const std::int32_t off = code_offset(coder, around, first, sign, limit, (truth - first) * sign);
    const std::int32_t value = first + sign * off;
    estimator_.learn(estimate, value);
    return value;
  }

 private:
  static constexpr std::int32_t kOne = IntensityEstimator::kOne;
  static constexpr int kTableBits = 13;
  static constexpr std::uint32_t kBuckets = 16;
  static constexpr std::uint32_t kWidths = 64;
  using Bits = BitMixer<kInputs>;

  // What contexts are made of.
  struct Around {
    std::uint32_t width = 0;     // how large errors are, in half octaves
    std::uint32_t fraction = 0;  // of the estimate, 1/16
    std::uint32_t sides = 0;     // the values on both sides
    int bucket_bits = 0;
  };

  [[nodiscard]] Around describe(const IntensityNeighbours& near,
                                const IntensityEstimator::Estimate& estimate) const {
    Around around;
    const auto error = static_cast<std::uint32_t>(estimate.error);
    const auto octave = static_cast<std::uint32_t>(std::bit_width(error));
    around.width = std::min(octave * 2 + ((error * 2 >> (octave - 1)) & 1U), kWidths - 1);
    around.fraction = static_cast<std::uint32_t>(estimate.value + kOne / 2) % kOne;
    around.bucket_bits = std::max(0, static_cast<int>(std::bit_width(error * 5 / 8)) - 5);
    if constexpr (kInputs > 1) {
      around.sides = coarse(near.value[0]) * 32U + coarse(near.value[1]);
    }
    return around;
  }

  [[nodiscard]] std::uint32_t coarse(std::int32_t value) const {
    return value < 0 ? 0U : 1U + ((static_cast<std::uint32_t>(value) * 20U) >> bits_);
  }

  // A decision that parts the values at `bound`. `detail` and `node`, below 4, say which
  // one it is.
  [[nodiscard]] static typename Bits::Contexts contexts(const Around& around, std::uint32_t detail,
                                                        std::uint32_t node, std::int32_t bound) {
    typename Bits::Contexts at;
    at[0] = (around.width * kBuckets + detail) * 4U + node;
    if constexpr (kInputs > 1) {
      at[1] = hash_context(static_cast<std::uint32_t>(bound) * 4U + node, around.sides);
    }
    return at;
  }

  // How far off a value is, 0 to `limit`.
  template <class Coder>
  std::int32_t code_offset(Coder& coder, const Around& around, std::int32_t first,
                           std::int32_t sign, std::int32_t limit, std::int32_t off) {
    const std::uint32_t side = sign > 0 ? 1U : 2U;
    int bits = around.bucket_bits;
    std::int32_t from = 0;
    std::uint32_t bucket = 0;
    for (; from + (1 << bits) <= limit; ++bucket) {
      const std::uint32_t number = std::min(bucket, kBuckets - 5);
      const std::uint32_t detail = bucket == 0 ? around.fraction / 4U : 4U + number;
      const std::int32_t next = from + (1 << bits);
      if (!bucket_.code(coder, contexts(around, detail, side, first + sign * next), number,
                        off >= next)) {
        break;
      }
      from = next;
      if (bucket >= kNarrowBuckets) ++bits;
    }
    const std::uint32_t which = around.width * 8U + std::min(bucket, 3U) * 2U + side - 1U;
    std::uint32_t node = 1;
    for (std::int32_t half = (1 << bits) / 2; half > 0; half /= 2) {
      if (from + half > limit) continue;
      const bool far = place_.code(coder, {which * 8U + node}, 0, off >= from + half);
      from += far ? half : 0;
      node = std::min(node * 2 + (far ? 1U : 0U), 7U);
    }
    return from;
  }

  static constexpr std::uint32_t kNarrowBuckets = 5;

  int bits_ = 8;
  IntensityEstimator estimator_;
  Bits side_{kTableBits, kWidths};
  Bits bucket_{kTableBits, kBuckets};
  BitMixer<1> place_{kTableBits, 1};
};

}  // namespace sweepcast::beam
