#include "codec/rcpcc/occupancy.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.hpp"

namespace sweepcast::rcpcc {
namespace {

using Mask = std::vector<std::int32_t>;

std::vector<std::byte> written(const Mask& ranges) {
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  write_occupancy(ranges, out);
  return bytes;
}

/// What is read of `bytes` into an image full of rubbish.
Mask read_back(std::span<const std::byte> bytes, std::size_t cells) {
  Mask mask(cells, -7);
  ByteReader in(bytes);
  EXPECT_TRUE(read_occupancy(in, mask));
  EXPECT_TRUE(in.ok());
  return mask;
}

Mask ones_of(const Mask& ranges) {
  Mask mask;
  for (const std::int32_t range : ranges) mask.push_back(range != 0 ? 1 : 0);
  return mask;
}

bool is_read(std::initializer_list<int> bytes, std::size_t cells) {
  std::vector<std::byte> raw;
  for (const int byte : bytes) raw.push_back(static_cast<std::byte>(byte));
  Mask mask(cells);
  ByteReader in(raw);
  return read_occupancy(in, mask);
}

TEST(Occupancy, RandomMasksRoundTrip) {
  std::mt19937 random(1);
  for (int round = 0; round < 300; ++round) {
    Mask ranges(static_cast<std::size_t>(test::uniform_int(random, 0, 3000)));
    const double change = std::pow(10.0, test::uniform(random, -4, 0));  // runs of all lengths
    bool occupied = round % 2 == 0;
    for (std::int32_t& range : ranges) {
      if (test::uniform(random, 0, 1) < change) occupied = !occupied;
      range = occupied ? test::uniform_int(random, 1, 500000) : 0;
    }
    EXPECT_EQ(read_back(written(ranges), ranges.size()), ones_of(ranges));
  }
}

TEST(Occupancy, FullAndEmptyMasksTakeAFewBytes) {
  const Mask full(10000, 5);
  const Mask empty(10000, 0);
  EXPECT_EQ(read_back(written(full), full.size()), ones_of(full));
  EXPECT_EQ(read_back(written(empty), empty.size()), empty);
  EXPECT_LE(written(full).size(), 4U);
  EXPECT_LE(written(empty).size(), 3U);
}

TEST(Occupancy, RunsMustFillTheImage) {
  EXPECT_TRUE(is_read({2, 3}, 5));
  EXPECT_FALSE(is_read({2, 2}, 5));  // ends a cell early
  EXPECT_FALSE(is_read({2, 4}, 5));  // a cell too many
  EXPECT_FALSE(is_read({}, 5));
  EXPECT_FALSE(is_read({0, 0, 0, 0}, 5));  // never gets anywhere
  EXPECT_FALSE(is_read({255}, 500));       // an escape without its number
  EXPECT_FALSE(is_read({255, 0xFF, 0xFF, 0xFF, 0xFF, 0x7F}, 500));
  EXPECT_TRUE(is_read({}, 0));
}

}  // namespace
}  // namespace sweepcast::rcpcc
