#include "codec/entropy/zstd_coder.hpp"

#include <gtest/gtest.h>

#include "core/random.hpp"

namespace sweepcast {
namespace {

using Bytes = std::vector<std::byte>;

Bytes random_bytes(std::mt19937& random, std::size_t size, int values) {
  Bytes bytes(size);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(test::uniform_int(random, 1, values));
  return bytes;
}

Bytes packed(const Bytes& raw, int level = 1) {
  Bytes out;
  ZstdEncoder(level).append(raw, out);
  return out;
}

TEST(ZstdCoder, RoundTripsAtEveryLevel) {
  std::mt19937 random(1);
  ZstdDecoder decoder;
  for (const int level : {1, 3, 9, 19, 22}) {
    ZstdEncoder encoder(level);
    for (const std::size_t size : {0, 1, 2, 100, 127, 128, 5000, 200000}) {
      for (const int values : {1, 3, 255}) {
        const Bytes raw = random_bytes(random, size, values);
        Bytes out;
        encoder.append(raw, out);
        Bytes back(7);
        ASSERT_TRUE(decoder.decode(out, size, back).has_value());
        EXPECT_EQ(back, raw);
      }
    }
  }
}

TEST(ZstdCoder, AppendsToWhatIsThere) {
  ZstdEncoder encoder(1);
  const Bytes raw(1000, std::byte{4});
  Bytes out(3, std::byte{9});
  encoder.append(raw, out);
  EXPECT_EQ(Bytes(out.begin(), out.begin() + 3), Bytes(3, std::byte{9}));
  EXPECT_EQ(Bytes(out.begin() + 3, out.end()), packed(raw));
  EXPECT_LT(out.size(), 40U);
}

TEST(ZstdCoder, RefusesMoreThanTheCap) {
  ZstdDecoder decoder;
  const Bytes out = packed(Bytes(1000, std::byte{4}));
  Bytes back(7);
  const Status status = decoder.decode(out, 999, back);
  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code, ErrorCode::limit);
  EXPECT_TRUE(back.empty());
  EXPECT_TRUE(decoder.decode(out, 1000, back).has_value());

  // A size of 2^63 must not be allocated.
  const Bytes huge{std::byte{0x80}, std::byte{0x80}, std::byte{0x80}, std::byte{0x80},
                   std::byte{0x80}, std::byte{0x80}, std::byte{0x80}, std::byte{0x80},
                   std::byte{0x80}, std::byte{0x01}};
  EXPECT_EQ(decoder.decode(huge, 1 << 20, back).error().code, ErrorCode::limit);
}

TEST(ZstdCoder, RefusesWhatDoesNotUnpackToItsSize) {
  std::mt19937 random(2);
  ZstdDecoder decoder;
  const Bytes raw = random_bytes(random, 500, 40);
  const Bytes out = packed(raw);
  Bytes back;
  const auto expect_corrupt = [&](const Bytes& bytes) {
    const Status status = decoder.decode(bytes, 1 << 16, back);
    ASSERT_FALSE(status.has_value());
    EXPECT_EQ(status.error().code, ErrorCode::corrupt);
    EXPECT_TRUE(back.empty());
  };
  expect_corrupt({});
  expect_corrupt({std::byte{0x80}});  // half a size
  expect_corrupt({std::byte{5}});     // a size without a body
  for (std::size_t size = 2; size < out.size(); size += 7) {
    expect_corrupt(Bytes(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(size)));
  }
  Bytes other_size = out;
  other_size[0] ^= std::byte{1};
  expect_corrupt(other_size);
  ASSERT_TRUE(decoder.decode(out, 1 << 16, back).has_value());  // and goes on after errors
  EXPECT_EQ(back, raw);
}

}  // namespace
}  // namespace sweepcast
