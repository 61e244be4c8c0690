// KITTI .bin: known bytes, and what is none.
#include <limits>

#include "io/formats.hpp"
#include "io/support.hpp"

namespace sweepcast {
namespace {

using test::bytes_of;
using test::expect_error;

TEST(Bin, ReadsAndWritesKnownBytes) {
  const auto bytes =
      bytes_of({"\0\0\x80\x3F"
                "\0\0\0\xC0"
                "\0\0\x40\x40"
                "\0\0\0\x3F",
                16});
  PointCloud cloud;
  ASSERT_TRUE(parse_bin(bytes, cloud));
  EXPECT_EQ(cloud.x, std::vector{1.0F});
  EXPECT_EQ(cloud.y, std::vector{-2.0F});
  EXPECT_EQ(cloud.z, std::vector{3.0F});
  EXPECT_EQ(cloud.intensity, std::vector{0.5F});
  std::vector<std::byte> written;
  serialize_bin(cloud, written);
  EXPECT_EQ(written, bytes);
  cloud.intensity.clear();
  serialize_bin(cloud, written);
  EXPECT_EQ(written, bytes_of({"\0\0\x80\x3F"
                               "\0\0\0\xC0"
                               "\0\0\x40\x40"
                               "\0\0\0\0",
                               16}));
}

TEST(Bin, RefusesWhatIsNone) {
  PointCloud cloud;
  expect_error(parse_bin({}, cloud), ErrorCode::truncated, "is empty");
  expect_error(parse_bin(bytes_of(std::string(17, 'a')), cloud), ErrorCode::truncated, "17 bytes");
  const auto begins = [&](std::string_view begin) {
    std::string text(32, 'x');
    text.replace(0, begin.size(), begin);
    return parse_bin(bytes_of(text), cloud);
  };
  expect_error(begins("# .PCD v0.7"), ErrorCode::unsupported, "a PCD file");
  expect_error(begins("VERSION .7"), ErrorCode::unsupported, "a PCD file");
  expect_error(begins("ply\n"), ErrorCode::unsupported, "a PLY file");
  expect_error(begins("ply\r\n"), ErrorCode::unsupported, "a PLY file");
  expect_error(begins("SWEEPCST"), ErrorCode::unsupported, "a .sweep file");
  expect_error(begins("PK\x03\x04"), ErrorCode::unsupported, "a zip archive");
  expect_error(begins("\x1F\x8B\x08"), ErrorCode::unsupported, "a gzip archive");
  const std::vector<std::byte> huge(((std::size_t{1} << 24) + 1) * 16);
  expect_error(parse_bin(huge, cloud), ErrorCode::limit, "16777217");
}

PointCloud cloud_of(const std::vector<float>& coordinates) {
  PointCloud cloud;
  for (std::size_t i = 0; i < coordinates.size(); i += 3) {
    cloud.x.push_back(coordinates[i]);
    cloud.y.push_back(coordinates[i + 1]);
    cloud.z.push_back(coordinates[i + 2]);
  }
  return cloud;
}

/// What reading a .bin with these coordinates gives.
Status read_back(const PointCloud& cloud) {
  std::vector<std::byte> bytes;
  serialize_bin(cloud, bytes);
  PointCloud again;
  return parse_bin(bytes, again);
}

TEST(Bin, RefusesBytesOfAnotherMeaning) {
  PointCloud cloud;
  const std::string table = "1.25,-3.5,0.75,9\n2.25,-3.5,0.75,9\n";  // numbers, but as text
  const std::string whole = table + table + table + table + table + table + table + table;
  expect_error(parse_bin(bytes_of(whole), cloud), ErrorCode::unsupported, "is text");
  expect_error(parse_bin(bytes_of(std::string(160, 'A')), cloud), ErrorCode::unsupported, "text");

  for (const std::size_t size : {1600U, 16000U, 160000U}) {
    std::mt19937_64 random(size);
    std::vector<std::byte> bytes(size);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() & 0xFF);
    expect_error(parse_bin(bytes, cloud), ErrorCode::unsupported, "cannot be coordinates");
  }
  std::vector<std::byte> counter;  // 32-bit integers, subnormal as float32
  for (std::uint32_t i = 1; i <= 400; ++i) {
    for (int k = 0; k < 4; ++k) counter.push_back(static_cast<std::byte>(i >> (8 * k)));
  }
  expect_error(parse_bin(counter, cloud), ErrorCode::unsupported, "cannot be coordinates");
}

TEST(Bin, TakesOddSweeps) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(read_back(cloud_of({10, 6e-16F, -4e-17F})));        // rounding of a cosine
  EXPECT_TRUE(read_back(cloud_of({0, 0, 0, 0, 0, 0, 0, 0, 0})));  // no return at all
  EXPECT_TRUE(read_back(cloud_of({kNan, kNan, kNan})));           // the same, organised
  EXPECT_TRUE(read_back(cloud_of({kInfinity, 1, 1, 1, 1, 1})));
  EXPECT_TRUE(read_back(cloud_of({458'000, 5'428'000, 110})));  // a map's metres
  EXPECT_TRUE(read_back(cloud_of({1e30F, 1e30F, 1e30F, 4, 5, 6})));
  EXPECT_FALSE(read_back(cloud_of({1e30F, 1e30F, 1e30F, 1e30F, 5, 6})));
}

}  // namespace
}  // namespace sweepcast
