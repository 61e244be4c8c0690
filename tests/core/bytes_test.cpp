#include "core/bytes.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "core/random.hpp"

namespace sweepcast {
namespace {

std::vector<std::byte> bytes_of(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

TEST(ByteWriter, AppendsLittleEndian) {
  std::vector<std::byte> bytes = bytes_of({7});
  ByteWriter out(bytes);
  out.put(std::uint32_t{0x01020304});
  out.put(std::int16_t{-2});
  EXPECT_EQ(bytes, bytes_of({7, 4, 3, 2, 1, 0xFE, 0xFF}));
}

TEST(ByteWriter, WritesVarintsAsLeb128) {
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  out.put_varint(0);
  out.put_varint(127);
  out.put_varint(128);
  out.put_varint(624485);  // the example of the DWARF standard
  EXPECT_EQ(bytes, bytes_of({0, 0x7F, 0x80, 0x01, 0xE5, 0x8E, 0x26}));
}

TEST(ByteWriter, MapsSignedNumbersByZigzag) {
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  for (const int value : {0, -1, 1, -2, 2, -64, 64}) out.put_signed(value);
  EXPECT_EQ(bytes, bytes_of({0, 1, 2, 3, 4, 127, 0x80, 0x01}));
}

TEST(ByteReader, ReadsExtremes) {
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  constexpr auto kLow = std::numeric_limits<std::int64_t>::min();
  constexpr auto kHigh = std::numeric_limits<std::int64_t>::max();
  constexpr auto kMost = std::numeric_limits<std::uint64_t>::max();
  out.put(kLow);
  out.put_signed(kLow);
  out.put_signed(kHigh);
  out.put_varint(kMost);
  out.put(std::int8_t{-128});
  out.put_text(std::string(255, 'x'));
  ByteReader in(bytes);
  EXPECT_EQ(in.get<std::int64_t>(), kLow);
  EXPECT_EQ(in.get_signed(), kLow);
  EXPECT_EQ(in.get_signed(), kHigh);
  EXPECT_EQ(in.get_varint(), kMost);
  EXPECT_EQ(in.get<std::int8_t>(), -128);
  EXPECT_EQ(in.get_text(), std::string(255, 'x'));
  EXPECT_TRUE(in.ok());
  EXPECT_TRUE(in.at_end());
}

TEST(ByteReader, PastTheEndTurnsBadAndStaysBad) {
  const auto bytes = bytes_of({1, 2, 3});
  ByteReader in(bytes);
  EXPECT_EQ(in.get<std::uint32_t>(), 0U);
  EXPECT_FALSE(in.ok());
  EXPECT_EQ(in.get<std::uint8_t>(), 0);  // though three bytes are left
  EXPECT_EQ(in.get_varint(), 0U);
  EXPECT_EQ(in.get_signed(), 0);
  EXPECT_TRUE(in.get_bytes(1).empty());
  EXPECT_TRUE(in.get_text().empty());
  EXPECT_FALSE(in.ok());
  EXPECT_TRUE(in.ran_out());
  EXPECT_EQ(in.position(), 0U);
  EXPECT_EQ(in.remaining(), 3U);
}

TEST(ByteReader, OfNothingIsAtItsEnd) {
  ByteReader in({});
  EXPECT_TRUE(in.ok());
  EXPECT_TRUE(in.at_end());
  EXPECT_TRUE(in.get_bytes(0).empty());
  EXPECT_TRUE(in.ok());
  EXPECT_EQ(in.get<std::uint8_t>(), 0);
  EXPECT_FALSE(in.ok());
}

TEST(ByteReader, RefusesSizesThatWouldOverflow) {
  const auto bytes = bytes_of({1, 2, 3});
  ByteReader in(bytes);
  EXPECT_EQ(in.get<std::uint8_t>(), 1);
  EXPECT_TRUE(in.get_bytes(std::numeric_limits<std::size_t>::max()).empty());
  EXPECT_FALSE(in.ok());
}

TEST(ByteReader, HoldsVarintsToTheirCap) {
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  out.put_varint(1000);
  out.put_varint(1001);
  out.put_varint(1);
  ByteReader in(bytes);
  EXPECT_EQ(in.get_varint(1000), 1000U);
  EXPECT_TRUE(in.ok());
  EXPECT_EQ(in.get_varint(1000), 0U);
  EXPECT_FALSE(in.ok());
  EXPECT_EQ(in.get_varint(1000), 0U);
  EXPECT_FALSE(in.ran_out());  // a value turned it bad
  EXPECT_TRUE(in.get_bytes(1000).empty());
  EXPECT_FALSE(in.ran_out());
}

TEST(ByteReader, RefusesVarintsBeyond64Bits) {
  auto bytes = bytes_of({0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x02});
  EXPECT_EQ(ByteReader(bytes).get_varint(), 0U);
  ByteReader beyond(bytes);
  EXPECT_EQ(beyond.get_varint(), 0U);
  EXPECT_FALSE(beyond.ok());
  bytes.back() = std::byte{0xFF};
  bytes.push_back(std::byte{0});
  ByteReader longer(bytes);
  EXPECT_EQ(longer.get_varint(), 0U);
  EXPECT_FALSE(longer.ok());
}

TEST(ByteReader, RefusesTextThatIsCut) {
  const auto bytes = bytes_of({4, 'a', 'b', 'c'});
  ByteReader in(bytes);
  EXPECT_EQ(in.get_text(), "");
  EXPECT_FALSE(in.ok());
}

TEST(Bytes, RandomRoundTrips) {
  std::mt19937 random(7);
  for (int round = 0; round < 50; ++round) {
    const std::uint32_t seed = test::random_bits(random);
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    const auto number = [](std::mt19937& r) {  // of every length
      const std::uint64_t high = r();
      return ((high << 32) | r()) >> (r() % 64);
    };
    std::mt19937 values(seed);
    for (int i = 0; i < 200; ++i) {
      const std::uint64_t value = number(values);
      switch (value % 5) {
        case 0:
          out.put_varint(value);
          break;
        case 1:
          out.put_signed(-static_cast<std::int64_t>(value / 2));
          break;
        case 2:
          out.put(static_cast<std::uint16_t>(value));
          break;
        case 3:
          out.put(static_cast<std::int64_t>(value));
          break;
        default:
          out.put_text(std::to_string(value));
      }
    }
    ByteReader in(bytes);
    std::mt19937 again(seed);
    for (int i = 0; i < 200; ++i) {
      const std::uint64_t value = number(again);
      switch (value % 5) {
        case 0:
          EXPECT_EQ(in.get_varint(), value);
          break;
        case 1:
          EXPECT_EQ(in.get_signed(), -static_cast<std::int64_t>(value / 2));
          break;
        case 2:
          EXPECT_EQ(in.get<std::uint16_t>(), static_cast<std::uint16_t>(value));
          break;
        case 3:
          EXPECT_EQ(in.get<std::int64_t>(), static_cast<std::int64_t>(value));
          break;
        default:
          EXPECT_EQ(in.get_text(), std::to_string(value));
      }
    }
    EXPECT_TRUE(in.ok());
    EXPECT_TRUE(in.at_end());
  }
}

}  // namespace
}  // namespace sweepcast
