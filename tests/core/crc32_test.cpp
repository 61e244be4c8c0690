#include "core/crc32.hpp"

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

namespace sweepcast {
namespace {

std::uint32_t crc_of(std::string_view text) {
  return crc32(std::as_bytes(std::span(text)));
}

TEST(Crc32, GivesPublishedValues) {
  EXPECT_EQ(crc_of("123456789"), 0xCBF43926U);  // the check value of the CRC catalogues
  EXPECT_EQ(crc_of(""), 0U);
  EXPECT_EQ(crc_of("The quick brown fox jumps over the lazy dog"), 0x414FA339U);
}

TEST(Crc32, OfTextAndItsChecksumIsTheResidue) {
  // Appending the checksum, low byte first, leaves a constant whatever the text.
  for (const std::string_view text : {"a", "sweep", "a longer text with 30 bytes in"}) {
    const std::uint32_t crc = crc_of(text);
    std::vector<std::byte> bytes(std::as_bytes(std::span(text)).begin(),
                                 std::as_bytes(std::span(text)).end());
    for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::byte>(crc >> (8 * i)));
    EXPECT_EQ(crc32(bytes), 0x2144DF1CU) << text;
  }
}

TEST(Crc32, SeesEverySingleBit) {
  std::vector<std::byte> bytes(64, std::byte{0x5A});
  const std::uint32_t sound = crc32(bytes);
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    EXPECT_NE(crc32(bytes), sound) << "bit " << bit;
    bytes[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
  }
}

}  // namespace
}  // namespace sweepcast
