// Symbols: both directions agree, shares are learnt, and the two ways to find and to learn are one.
#include "codec/entropy/symbol_coder.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.hpp"

namespace sweepcast {
namespace {

using test::random_bits;

SymbolShares even_shares() {
  SymbolShares shares;
  for (std::size_t k = 0; k < kSymbols; ++k) shares.from[k] = static_cast<std::int16_t>(2048 * k);
  return shares;
}

struct Event {
  std::size_t context;
  std::uint32_t symbol;
};

/// Symbols that halve in frequency from one to the next, but for those of context 1: all alike.
std::vector<Event> drawn(int count, std::mt19937& random) {
  std::vector<Event> events;
  for (int i = 0; i < count; ++i) {
    const std::size_t context = random_bits(random) % 4;
    const std::uint32_t bits = random_bits(random) | 0x8000U;
    const auto zeros = static_cast<std::uint32_t>(std::countr_zero(bits));
    events.push_back({context, context == 1 ? random_bits(random) % 16 : zeros});
  }
  return events;
}

std::vector<std::byte> encode(const std::vector<Event>& events) {
  SymbolCoder symbols(4);
  symbols.reset(even_shares());
  std::vector<std::byte> bytes;
  RangeEncoder coder(bytes);
  for (const Event& event : events) {
    EXPECT_EQ(symbols.code(coder, event.context, event.symbol), event.symbol);
    (void)coder.code(event.symbol % 2 == 0, 20'000);  // bits may stand between symbols
  }
  coder.finish();
  return bytes;
}

TEST(SymbolCoder, DecoderFollowsTheEncoder) {
  std::mt19937 random(1);
  for (const int count : {0, 1, 2, 50, 20'000}) {
    const std::vector<Event> events = drawn(count, random);
    const std::vector<std::byte> bytes = encode(events);
    SymbolCoder symbols(4);
    symbols.reset(even_shares());
    RangeDecoder coder(bytes);
    for (const Event& event : events) {
      ASSERT_EQ(symbols.code(coder, event.context, 0), event.symbol);
      ASSERT_EQ(coder.code(false, 20'000), event.symbol % 2 == 0);
    }
    EXPECT_FALSE(coder.overran());
  }
}

TEST(SymbolCoder, LearnsShares) {
  std::mt19937 random(2);
  const std::vector<Event> events = drawn(100'000, random);
  SymbolCoder symbols(4);
  symbols.reset(even_shares());
  std::vector<std::byte> bytes;
  RangeEncoder coder(bytes);
  for (const Event& event : events) (void)symbols.code(coder, event.context, event.symbol);
  coder.finish();
  // Two bits a symbol where they halve, four where all are alike: 2.5 in the mean.
  EXPECT_NEAR(static_cast<double>(bytes.size()) * 8 / 100'000, 2.5, 0.08);
}

TEST(SymbolCoder, AnyBytesGiveSymbols) {
  std::mt19937 random(3);
  for (int run = 0; run < 200; ++run) {
    std::vector<std::byte> bytes(random_bits(random) % 40);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random_bits(random));
    SymbolCoder symbols(4);
    symbols.reset(even_shares());
    RangeDecoder coder(bytes);
    for (int i = 0; i < 300; ++i) ASSERT_LT(symbols.code(coder, random_bits(random) % 4, 0), 16U);
    EXPECT_TRUE(coder.overran());
  }
}

TEST(SymbolCoder, BothWaysFindAndLearnTheSame) {
  std::mt19937 random(4);
  SymbolShares fast = even_shares();
  SymbolShares slow = fast;
  for (int i = 0; i < 20'000; ++i) {
    const std::uint32_t width = 32'768 + random_bits(random) % 32'768;
    const std::uint32_t place = random_bits(random) % width;
    const std::uint32_t symbol = plain::find_symbol(slow, width, place);
    ASSERT_EQ(symbol_detail::find_symbol(fast, width, place), symbol);
    ASSERT_LE(slow.begin(symbol, width), place);
    ASSERT_TRUE(symbol == 15 || slow.begin(symbol + 1, width) > place);
    SymbolShares target;
    for (std::size_t k = 1; k < kSymbols; ++k) {
      target.from[k] = static_cast<std::int16_t>(k > symbol ? 32'768 - 16 * (16 - k) : 16 * k);
    }
    const int rate = 2 + static_cast<int>(random_bits(random) % 5);
    symbol_detail::approach(target, rate, fast);
    plain::approach(target, rate, slow);
    ASSERT_EQ(fast.from, slow.from);
    for (std::size_t k = 1; k < kSymbols; ++k) ASSERT_GE(slow.from[k] - slow.from[k - 1], 16);
  }
}

}  // namespace
}  // namespace sweepcast
