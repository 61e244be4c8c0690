// A context-mixing model of bits: several adaptive probabilities, each under a context of its own,
// combined in the logistic domain by weights that learn which of them to trust.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/entropy/logistic.hpp"
#include "codec/entropy/range_coder.hpp"
#include "codec/entropy/slot.hpp"

namespace sweepcast {

/// Mixes `kInputs` contexts. The first bits of a context are followed fast, later ones slowly.
template <std::size_t kInputs>
class BitMixer {
 public:
  using Contexts = std::array<std::uint32_t, kInputs>;

  /// Each input has 2^table_bits probabilities; each of `weight_sets` sets learns by itself.
  BitMixer(int table_bits, std::size_t weight_sets)
      : mask_((std::uint32_t{1} << table_bits) - 1),
        slots_(kInputs << table_bits),
        weights_(weight_sets) {
    reset();
  }

  /// Forgets everything, for the next sweep.
  void reset() {
    std::fill(slots_.begin(), slots_.end(), Slot{});
    Weights fresh{};
    for (std::size_t i = 0; i < kInputs; ++i) fresh[i] = kFirstWeight;
    std::fill(weights_.begin(), weights_.end(), fresh);
  }

  /// Lets what was learnt be overruled fast, as if no slot had learnt more than `most` bits.
  void soften(std::uint16_t most) {
    for (Slot& slot : slots_) slot.count = std::min(slot.count, most);
  }

  /// Codes one bit through `coder` (a RangeEncoder or RangeDecoder) under hashed contexts and a
  /// set of weights; returns the bit.
  template <class Coder>
  bool code(Coder& coder, const Contexts& contexts, std::size_t weight_set, bool bit) {
    if constexpr (kInputs == 1) {  // nothing to mix
      Slot& slot = slots_[contexts[0] & mask_];
      bit = coder.code(bit, std::clamp<std::uint32_t>(slot.p, kLeast, 65'536 - kLeast));
      slot.learn(bit);
      return bit;
    }
    std::array<Slot*, kInputs> slots;
    std::array<std::int32_t, kTerms> terms;
    Weights& weights = weights_[weight_set];
    for (std::size_t i = 0; i < kInputs; ++i) {
      Slot& slot = slots_[i * (std::size_t{mask_} + 1) + (contexts[i] & mask_)];
      slots[i] = &slot;
      terms[i] = stretch(slot.p);
    }
    std::uint32_t dot = 0;  // unsigned: were it ever to overflow, it would do so everywhere alike
    for (std::size_t i = 0; i < kTerms; ++i) {
      dot += static_cast<std::uint32_t>(terms[i]) * static_cast<std::uint32_t>(weights[i] >> 4);
    }
    const std::uint32_t p = squash(static_cast<std::int32_t>(dot) >> (kWeightBits - 4));
    bit = coder.code(bit, p);

    const std::int32_t error = (bit ? 65535 : 0) - static_cast<std::int32_t>(p);
    for (std::size_t i = 0; i < kTerms; ++i) {
      weights[i] += (terms[i] * error + kRateHalf) >> kRateShift;
    }
    for (Slot* slot : slots) slot->learn(bit);
    return bit;
  }

 private:
  static constexpr std::size_t kTerms = kInputs;
  static constexpr int kWeightBits = 18;
  static constexpr std::int32_t kFirstWeight = 50000;  // about a third
  static constexpr int kRateShift = 13;
  static constexpr int kRateHalf = 1 << (kRateShift - 1);
  static constexpr std::uint32_t kLeast = 24;
  using Weights = std::array<std::int32_t, kTerms>;

  std::uint32_t mask_;
  std::vector<Slot> slots_;
  std::vector<Weights> weights_;
};

/// Spreads two numbers over 32 bits, for contexts.
[[nodiscard]] inline std::uint32_t hash_context(std::uint32_t a, std::uint32_t b) {
  std::uint32_t h = a * 0x9E3779B1U ^ (b + 0x7F4A7C15U) * 0x85EBCA6BU;
  h ^= h >> 15;
  h *= 0x2C1B3C6DU;
  return h ^ (h >> 13);
}

}  // namespace sweepcast
