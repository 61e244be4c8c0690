// The binary arithmetic coder and its logistic tables, against the ideal code length and
// 1/(1+e^-x).
#include "codec/entropy/range_coder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "codec/entropy/logistic.hpp"
#include "core/random.hpp"

namespace sweepcast {
namespace {

using test::random_bits;
using test::uniform;

struct Message {
  std::vector<std::pair<bool, std::uint32_t>> bits;  // and their probabilities of being 1
  double ideal_bytes = 0;

  void add(bool bit, std::uint32_t p1) {
    bits.emplace_back(bit, p1);
    ideal_bytes -= std::log2((bit ? p1 : 65536.0 - p1) / 65536.0) / 8;
  }
};

std::vector<std::byte> encode(const Message& message) {
  std::vector<std::byte> bytes;
  RangeEncoder coder(bytes);
  for (const auto& [bit, p1] : message.bits) EXPECT_EQ(coder.code(bit, p1), bit);
  coder.finish();
  return bytes;
}

std::span<const std::byte> first(const std::vector<std::byte>& bytes, std::size_t size) {
  return std::span<const std::byte>(bytes).first(size);
}

void expect_round_trip(const Message& message) {
  const std::vector<std::byte> bytes = encode(message);
  RangeDecoder coder(bytes);
  std::size_t wrong = 0;
  for (const auto& [bit, p1] : message.bits) wrong += coder.code(false, p1) == bit ? 0U : 1U;
  EXPECT_EQ(wrong, 0U);
  EXPECT_FALSE(coder.overran());
}

/// Bits drawn from their own probabilities, so that the ideal length is what a coder can reach.
Message drawn(std::mt19937& random, int count, std::uint32_t lowest, std::uint32_t highest) {
  Message message;
  for (int i = 0; i < count; ++i) {
    const std::uint32_t p1 = lowest + random_bits(random) % (highest - lowest + 1);
    message.add(random_bits(random) % 65536 < p1, p1);
  }
  return message;
}

TEST(RangeCoder, BitsOfAnyProbabilityComeBack) {
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    Message message;
    for (int n = test::uniform_int(random, 0, 600); n > 0; --n) {
      const std::uint32_t p1 = random_bits(random) % 4 == 0   ? 16U
                               : random_bits(random) % 3 == 0 ? 65'520U
                                                              : 16U + random_bits(random) % 65'505U;
      message.add(random_bits(random) % 2 == 0, p1);
    }
    expect_round_trip(message);
  }
}

TEST(RangeCoder, SizeIsNearTheIdeal) {
  std::mt19937 random(2);
  for (const auto& [lowest, highest] :
       {std::pair{16U, 65'520U}, {30'000U, 35'000U}, {16U, 400U}, {65'000U, 65'520U}}) {
    const Message message = drawn(random, 100'000, lowest, highest);
    expect_round_trip(message);
    const auto size = static_cast<double>(encode(message).size());
    EXPECT_LE(size, message.ideal_bytes * 1.001 + 8) << lowest;
    EXPECT_GE(size, message.ideal_bytes * 0.999 - 1) << lowest;
  }
}

TEST(RangeCoder, AnEmptyMessageNeedsNoBytes) {
  EXPECT_TRUE(encode({}).empty());
  const RangeDecoder coder({});
  EXPECT_FALSE(coder.overran());
}

TEST(RangeCoder, ImprobableBitsInARow) {
  Message message;
  for (int i = 0; i < 2000; ++i) message.add(i % 2 == 0, i % 2 == 0 ? 16 : 65'520);
  expect_round_trip(message);
  EXPECT_LE(static_cast<double>(encode(message).size()), message.ideal_bytes * 1.001 + 8);
}

TEST(RangeCoder, ReadingPastTheEndShows) {
  std::mt19937 random(3);
  const Message message = drawn(random, 20'000, 20'000, 45'000);
  const std::vector<std::byte> bytes = encode(message);
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, bytes.size() / 2}) {
    RangeDecoder coder(first(bytes, size));
    for (const auto& [bit, p1] : message.bits) (void)coder.code(false, p1);
    EXPECT_TRUE(coder.overran()) << size;
  }
}

TEST(RangeCoder, TheBeginningOfCutBytesStillDecodes) {
  std::mt19937 random(4);
  const Message message = drawn(random, 20'000, 20'000, 45'000);
  const std::vector<std::byte> bytes = encode(message);
  RangeDecoder coder(first(bytes, bytes.size() / 2));
  for (std::size_t i = 0; i < message.bits.size() / 3; ++i) {
    ASSERT_EQ(coder.code(false, message.bits[i].second), message.bits[i].first) << i;
  }
  EXPECT_FALSE(coder.overran());
}

TEST(Logistic, SquashIsTheLogisticFunction) {
  for (int x = -kLogisticLimit; x <= kLogisticLimit; ++x) {
    const double truth = 65536.0 / (1.0 + std::exp(-x / 256.0));
    EXPECT_NEAR(squash(x), std::min(std::max(truth, 24.0), 65512.0), 1.0) << x;
    EXPECT_GE(squash(x), squash(x - 1)) << x;
  }
  EXPECT_EQ(squash(-1'000'000), squash(-kLogisticLimit));
  EXPECT_EQ(squash(1'000'000), squash(kLogisticLimit));
  EXPECT_EQ(squash(0), 32768U);
}

TEST(Logistic, StretchIsItsInverse) {
  for (std::uint32_t p = 16; p < 65520; ++p) {
    EXPECT_GE(stretch(p), stretch(p - 1)) << p;
    // Within the table's cell of 16 / 65536, whose ends lie 16 / (p (1 - p)) apart.
    const double share = (std::floor(p / 16.0) * 16 + 8) / 65536.0;
    const double truth = 256.0 * std::log(share / (1 - share));
    const double slope = 256.0 / (share * (1 - share)) / 65536.0;
    if (std::abs(truth) < 2000) {
      EXPECT_NEAR(stretch(p), truth, 2.0 + 2 * slope) << p;
    }
  }
  EXPECT_EQ(stretch(0), -kLogisticLimit);
  EXPECT_EQ(stretch(65535), kLogisticLimit);
}

}  // namespace
}  // namespace sweepcast
