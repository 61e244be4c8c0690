// Binary arithmetic coding: bits with probabilities into bytes and back. Integer arithmetic only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sweepcast {

/// Probabilities of a 1 are in 1/65536, from 1 to 65535.
inline constexpr int kProbabilityBits = 16;

/// Appends to a vector of bytes. The interval [low, high] narrows with each bit; bytes that both
/// ends agree on are written.
class RangeEncoder {
 public:
  explicit RangeEncoder(std::vector<std::byte>& out) : out_(out) {}

  /// Codes `bit`, to which the model gives probability `p1` of being 1. Returns `bit`, as
  /// `RangeDecoder::code` does, so that one function can serve both directions.
  bool code(bool bit, std::uint32_t p1) {
    const std::uint32_t span = high_ - low_;
    const std::uint32_t middle =
        low_ +
        static_cast<std::uint32_t>((static_cast<std::uint64_t>(span) * p1) >> kProbabilityBits);
    if (bit) {
      high_ = middle;
    } else {
      low_ = middle + 1;
    }
    while (((low_ ^ high_) & 0xFF000000U) == 0) {
      out_.push_back(static_cast<std::byte>(high_ >> 24));
      low_ <<= 8;
      high_ = (high_ << 8) | 0xFFU;
    }
    return bit;
  }

  /// Writes what the decoder needs to tell the last bits.
  void finish() {
    // Any number in [low, high] will do; past the end, the decoder reads zeros.
    for (int shift = 24; low_ != 0; shift -= 8) {
      const std::uint32_t mask = 0xFFFFFFFFU << shift;
      const std::uint32_t value = (low_ + ~mask) & mask;
      if (value >= low_ && value <= high_) {
        for (int at = 24; at >= shift; at -= 8) {
          out_.push_back(static_cast<std::byte>(value >> at));
        }
        break;
      }
    }
    low_ = 0;
    high_ = 0xFFFFFFFFU;
  }

 private:
  std::vector<std::byte>& out_;
  std::uint32_t low_ = 0;
  std::uint32_t high_ = 0xFFFFFFFFU;
};

/// Reads what `RangeEncoder` wrote. Past the end it reads zeros: damaged bytes give wrong bits,
/// never a fault; the frame's checksum is what finds damage.
class RangeDecoder {
 public:
  explicit RangeDecoder(std::span<const std::byte> bytes) : bytes_(bytes) {
    for (int i = 0; i < 4; ++i) code_ = (code_ << 8) | next();
  }

  /// The next bit; the argument is for symmetry with the encoder and not used.
  bool code(bool /*bit*/, std::uint32_t p1) {
    const std::uint32_t span = high_ - low_;
    const std::uint32_t middle =
        low_ +
        static_cast<std::uint32_t>((static_cast<std::uint64_t>(span) * p1) >> kProbabilityBits);
    const bool bit = code_ <= middle;
    if (bit) {
      high_ = middle;
    } else {
      low_ = middle + 1;
    }
    while (((low_ ^ high_) & 0xFF000000U) == 0) {
      low_ <<= 8;
      high_ = (high_ << 8) | 0xFFU;
      code_ = (code_ << 8) | next();
    }
    return bit;
  }

  /// True where more was read than is there by over four bytes, as only damage explains.
  [[nodiscard]] bool overran() const { return at_ > bytes_.size() + 4; }

 private:
  std::uint32_t next() {
    const std::size_t at = at_++;
    return at < bytes_.size() ? static_cast<std::uint32_t>(bytes_[at]) : 0;
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::uint32_t low_ = 0;
  std::uint32_t high_ = 0xFFFFFFFFU;
  std::uint32_t code_ = 0;
};

/// Whether damaged bytes have ended, so that a few of them cannot keep the decoder busy for long.
[[nodiscard]] inline bool ran_dry(const RangeDecoder& coder) {
  return coder.overran();
}
/// The encoder's side of functions that serve both: never.
[[nodiscard]] inline bool ran_dry(const RangeEncoder& /*coder*/) {
  return false;
}

}  // namespace sweepcast
