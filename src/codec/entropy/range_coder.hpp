// Arithmetic coding: bits and symbols with probabilities into bytes and back. Integer arithmetic
// only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace sweepcast {

/// Probabilities of a 1 are in 1/65536, from 16 to 65520.
inline constexpr int kProbabilityBits = 16;

namespace range_detail {

/// Ranges below are widened before a bit is coded: so it leaves 2^15 at least, and widening takes
/// 16 bits at most.
inline constexpr std::uint32_t kLeast = std::uint32_t{1} << 27;

/// Of a number that is not 0: std::bit_width takes care of that, which costs a branch.
[[nodiscard]] inline std::uint32_t floor_log2(std::uint32_t v) {
  return 31U ^ static_cast<std::uint32_t>(__builtin_clz(v));
}

/// How much of a range belongs to a 1.
[[nodiscard]] inline std::uint32_t share(std::uint32_t range, std::uint32_t p1) {
  return static_cast<std::uint32_t>((std::uint64_t{range} * p1) >> kProbabilityBits);
}

}  // namespace range_detail

/// Appends to a vector of bytes. What is coded is a number in [low, low + range): each bit narrows
/// it, to its lower part for a 1.
class RangeEncoder {
 public:
  explicit RangeEncoder(std::vector<std::byte>& out) : out_(out) {}

  /// Codes `bit`, to which the model gives probability `p1` of being 1. Returns `bit`, as
  /// `RangeDecoder::code` does, so that one function can serve both directions.
  bool code(bool bit, std::uint32_t p1) {
    if (range_ < range_detail::kLeast) normalise();
    const std::uint32_t one = range_detail::share(range_, p1);
    low_ += bit ? 0 : one;
    range_ = bit ? one : range_ - one;
    return bit;
  }

  /// Widens the range for a symbol, and gives its upper 16 bits, at least 2^15, to be shared out.
  [[nodiscard]] std::uint32_t width() {
    normalise();
    return range_ >> 16;
  }

  /// Codes a symbol whose part of the range is [from, to), in units of `width()`; 0 for `to`: up to
  /// the range's end.
  void narrow(std::uint32_t from, std::uint32_t to) {
    low_ += std::uint64_t{from} << 16;
    range_ = (to == 0 ? range_ : to << 16) - (from << 16);
  }

  /// Writes what the decoder needs to tell the last bits.
  void finish() {
    // Any number inside will do, so the one with the fewest bytes: past the end, zeros are read.
    const int bits = 32 + pending_;
    for (int kept = 0; kept <= bits; kept += 8) {
      const std::uint64_t below = (std::uint64_t{1} << (bits - kept)) - 1;
      const std::uint64_t value = (low_ + below) & ~below;
      if (value - low_ >= range_) continue;
      if ((value >> bits) != 0) carry();
      for (int at = 8; at <= kept; at += 8) {
        out_.push_back(static_cast<std::byte>(value >> (bits - at)));
      }
      break;
    }
    low_ = 0;
    range_ = 0xFFFFFFFFU;
    pending_ = 0;
  }

 private:
  // Makes the range at least 2^31 again; writes two bytes once they are there.
  void normalise() {
    const int shift = 31 - static_cast<int>(range_detail::floor_log2(range_));
    range_ <<= shift;
    low_ <<= shift;
    pending_ += shift;
    if (pending_ < 16) return;
    pending_ -= 16;
    const std::uint64_t ready = low_ >> (32 + pending_);
    if ((ready >> 16) != 0) carry();
    out_.push_back(static_cast<std::byte>(ready >> 8));
    out_.push_back(static_cast<std::byte>(ready));
    low_ &= (std::uint64_t{1} << (32 + pending_)) - 1;
  }

  // Adds 1 to what is written: never beyond this coder's bytes, whose number is below 1.
  void carry() {
    for (std::size_t at = out_.size(); at-- > 0;) {
      out_[at] = static_cast<std::byte>(static_cast<unsigned>(out_[at]) + 1U);
      if (out_[at] != std::byte{0}) return;
    }
  }

  std::vector<std::byte>& out_;
  std::uint64_t low_ = 0;  // 32 bits, those pending above them, and a carry
  std::uint32_t range_ = 0xFFFFFFFFU;
  int pending_ = 0;  // bits of `low_` to be written, below 16 between calls
};

/// Reads what `RangeEncoder` wrote. Past the end it reads zeros: damaged bytes give wrong bits,
/// never a fault; the frame's checksum is what finds damage.
class RangeDecoder {
 public:
  explicit RangeDecoder(std::span<const std::byte> bytes) : bytes_(bytes) {
    for (int i = 0; i < 8; ++i) rest_ = (rest_ << 8) | next();
  }

  /// The next bit; the argument is for symmetry with the encoder and not used.
  bool code(bool /*bit*/, std::uint32_t p1) {
    if (range_ < range_detail::kLeast) normalise();
    const std::uint32_t one = range_detail::share(range_, p1);
    const std::uint64_t from = std::uint64_t{one} << 32;
    const bool bit = rest_ < from;
    rest_ -= bit ? 0 : from;
    range_ = bit ? one : range_ - one;
    return bit;
  }

  /// As the encoder's.
  [[nodiscard]] std::uint32_t width() {
    normalise();
    return range_ >> 16;
  }

  /// Where in the range the next symbol lies, in units of `width()`.
  [[nodiscard]] std::uint32_t place() const { return static_cast<std::uint32_t>(rest_ >> 48); }

  /// Passes over the symbol at `place()`, as the encoder coded it.
  void narrow(std::uint32_t from, std::uint32_t to) {
    rest_ -= std::uint64_t{from} << 48;
    range_ = (to == 0 ? range_ : to << 16) - (from << 16);
  }

  /// True where more was read than is there by over eight bytes, as only damage explains.
  [[nodiscard]] bool overran() const { return at_ > bytes_.size() + 8; }

 private:
  void normalise() {
    const int shift = 31 - static_cast<int>(range_detail::floor_log2(range_));
    range_ <<= shift;
    rest_ <<= shift;
    ahead_ -= shift;
    if (ahead_ >= 16) return;
    ahead_ += 16;
    const std::uint64_t high = next();
    rest_ |= ((high << 8) | next()) << (32 - ahead_);
  }

  std::uint32_t next() {
    const std::size_t at = at_++;
    return at < bytes_.size() ? static_cast<std::uint32_t>(bytes_[at]) : 0;
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::uint64_t rest_ = 0;  // what is read less what is passed: 32 bits of the range, then `ahead_`
  std::uint32_t range_ = 0xFFFFFFFFU;
  int ahead_ = 32;  // bits read ahead of the range's 32, at least 16 between calls
};

/// Which way a function goes that serves both.
template <class Coder>
inline constexpr bool kDecodes = std::is_same_v<Coder, RangeDecoder>;

/// Whether damaged bytes have ended, so that a few of them cannot keep the decoder busy for long.
[[nodiscard]] inline bool ran_dry(const RangeDecoder& coder) {
  return coder.overran();
}
/// The encoder's side of functions that serve both: never.
[[nodiscard]] inline bool ran_dry(const RangeEncoder& /*coder*/) {
  return false;
}

}  // namespace sweepcast
