// Tells whether content has changed.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

namespace sweepcast::lab {

/// 64 bits that change with what is added, and with how it is divided into calls. Finds changes;
/// does not resist someone who looks for equal hashes.
class ContentHash {
 public:
  ContentHash& add(std::span<const std::byte> bytes) {
    mix(bytes.size());
    std::size_t at = 0;
    for (; at + 8 <= bytes.size(); at += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes.data() + at, 8);
      mix(word);
    }
    std::uint64_t rest = 0;
    if (at < bytes.size()) std::memcpy(&rest, bytes.data() + at, bytes.size() - at);
    mix(rest);
    return *this;
  }
  ContentHash& add(std::string_view text) { return add(std::as_bytes(std::span(text))); }
  ContentHash& add(std::uint64_t number) {
    mix(number);
    return *this;
  }

  [[nodiscard]] std::uint64_t value() const {
    std::uint64_t end = state_ ^ (state_ >> 32);
    end *= 0xD6E8FEB86659FD93ULL;
    return end ^ (end >> 29);
  }

  /// 16 digits.
  [[nodiscard]] std::string hex() const {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text(16, '0');
    for (unsigned i = 0; i < 16; ++i) text[i] = kDigits[value() >> (60 - 4 * i) & 15U];
    return text;
  }

 private:
  void mix(std::uint64_t word) { state_ = std::rotl((state_ ^ word) * 0x9E3779B97F4A7C15ULL, 31); }

  std::uint64_t state_ = 0x243F6A8885A308D3ULL;
};

}  // namespace sweepcast::lab
