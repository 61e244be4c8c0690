// KITTI .bin: known bytes, and what is none.
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

}  // namespace
}  // namespace sweepcast
