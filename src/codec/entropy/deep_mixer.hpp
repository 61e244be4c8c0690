// A context-mixing model of bits for the fewest bytes: beside adaptive probabilities it mixes what
// the caller expects, twice, and corrects the outcome by what such outcomes turned out to be worth.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/entropy/logistic.hpp"
#include "codec/entropy/slot.hpp"

namespace sweepcast {

/// Mixes `kGiven` expectations and `kContexts` contexts.
template <std::size_t kGiven, std::size_t kContexts>
class DeepMixer {
 public:
  /// What a bit is coded under.
  struct Bit {
    std::array<std::int32_t, kGiven> given;  ///< logistic domain, within its limits
    std::array<std::uint32_t, kContexts> contexts;
    std::size_t first_set;   ///< of weights; two mixtures, whose mean counts
    std::size_t second_set;  ///< of weights
    std::size_t correction;  ///< which curve corrects the outcome
  };

  /// Each context has 2^table_bits probabilities. So many sets of weights there are for the first
  /// and for the second mixture, and so many curves.
  DeepMixer(int table_bits, std::size_t first_sets, std::size_t second_sets, std::size_t curves)
      : mask_((std::uint32_t{1} << table_bits) - 1),
        slots_(kContexts << table_bits),
        first_(first_sets),
        second_(second_sets),
        curves_(curves) {
    reset();
  }

  /// Forgets everything, for the next sweep.
  void reset() {
    std::fill(slots_.begin(), slots_.end(), Slot{});
    Weights fresh{};
    fresh.fill(kFirstWeight);
    fresh.back() = 0;
    std::fill(first_.begin(), first_.end(), fresh);
    std::fill(second_.begin(), second_.end(), fresh);
    std::fill(curves_.begin(), curves_.end(), kStraight);
  }

  /// Lets what was learnt be overruled fast, as if no slot had learnt more than `most` bits.
  void soften(std::uint16_t most) {
    for (Slot& slot : slots_) slot.count = std::min(slot.count, most);
  }

  /// Codes one bit through `coder` (a RangeEncoder or RangeDecoder); returns the bit.
  template <class Coder>
  bool code(Coder& coder, const Bit& at, bool bit) {
    std::array<Slot*, kContexts> slots;
    std::array<std::int32_t, kTerms> terms;
    std::copy(at.given.begin(), at.given.end(), terms.begin());
    for (std::size_t i = 0; i < kContexts; ++i) {
      slots[i] = &slots_[i * (std::size_t{mask_} + 1) + (at.contexts[i] & mask_)];
      terms[kGiven + i] = stretch(slots[i]->p);
    }
    terms[kTerms - 1] = kLogisticOne;  // its weight says what bits are as a rule
    Weights& first = first_[at.first_set];
    Weights& second = second_[at.second_set];
    const std::int32_t by_first = mix(terms, first);
    const std::int32_t by_second = mix(terms, second);
    const std::int32_t mean = (by_first + by_second) >> 1;

    // Between two points of the curve.
    const std::int32_t place = mean + 2048;
    std::uint16_t* const point = &curves_[at.correction][static_cast<std::size_t>(place >> 7)];
    const std::int32_t beyond = place & 127;
    const std::int32_t corrected = (point[0] * (128 - beyond) + point[1] * beyond) >> 7;
    const std::int32_t p = (static_cast<std::int32_t>(squash(mean)) + corrected) >> 1;
    bit = coder.code(bit, static_cast<std::uint32_t>(std::clamp(p, kLeast, 65'536 - kLeast)));

    const std::int32_t target = bit ? 65535 : 0;
    learn(first, terms, target - static_cast<std::int32_t>(squash(by_first)));
    learn(second, terms, target - static_cast<std::int32_t>(squash(by_second)));
    for (Slot* slot : slots) slot->learn(bit);
    std::uint16_t& nearer = point[beyond >> 6];
    nearer = static_cast<std::uint16_t>(nearer + ((target - nearer) >> kCurveShift));
    return bit;
  }

 private:
  static constexpr std::size_t kTerms = kGiven + kContexts + 1;
  static constexpr std::int32_t kFirstWeight = 115'000 / static_cast<int>(kTerms);
  static constexpr int kWeightBits = 16;
  static constexpr int kRateShift = 15;
  static constexpr int kCurveShift = 6;
  static constexpr std::int32_t kLeast = 24;
  using Weights = std::array<std::int32_t, kTerms>;
  using Curve = std::array<std::uint16_t, 33>;  ///< outcomes, 128 apart in the logistic domain

  static constexpr Curve kStraight = [] {
    Curve curve{};
    for (std::size_t i = 0; i < curve.size(); ++i) {
      curve[i] = logistic_detail::kSquash[std::min<std::size_t>(i * 128, 4095)];
    }
    return curve;
  }();

  static std::int32_t mix(const std::array<std::int32_t, kTerms>& terms, const Weights& weights) {
    std::uint32_t dot = 0;  // unsigned: were it ever to overflow, it would do so everywhere alike
    for (std::size_t i = 0; i < kTerms; ++i) {
      dot += static_cast<std::uint32_t>(terms[i]) * static_cast<std::uint32_t>(weights[i] >> 2);
    }
    return std::clamp(static_cast<std::int32_t>(dot) >> (kWeightBits - 2), -kLogisticLimit,
                      kLogisticLimit);
  }

  static void learn(Weights& weights, const std::array<std::int32_t, kTerms>& terms,
                    std::int32_t error) {
    for (std::size_t i = 0; i < kTerms; ++i) {
      weights[i] += (terms[i] * error + (1 << (kRateShift - 1))) >> kRateShift;
    }
  }

  std::uint32_t mask_;
  std::vector<Slot> slots_;
  std::vector<Weights> first_, second_;
  std::vector<Curve> curves_;
};

}  // namespace sweepcast
