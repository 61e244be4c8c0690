// PCD as others write it.
#include <cmath>

#include "io/formats.hpp"
#include "io/support.hpp"

namespace sweepcast {
namespace {

using test::bytes_of;
using test::expect_error;

Status parse(std::string_view text, PointCloud& cloud) {
  return parse_pcd(bytes_of(text), cloud);
}

Status parse(std::string_view text) {
  PointCloud cloud;
  return parse(text, cloud);
}

/// A text PCD of these fields with one point.
std::string one_point(std::string_view fields, std::string_view sizes, std::string_view types,
                      std::string_view counts, std::string_view point) {
  std::string text = "VERSION 0.7\nFIELDS ";
  ((((text += fields) += "\nSIZE ") += sizes) += "\nTYPE ") += types;
  ((text += "\nCOUNT ") += counts) += "\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n";
  return text += point;
}

const std::string kHeader = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\n";

TEST(Pcd, ReadsTheTextOfPcl) {
  PointCloud cloud;
  ASSERT_TRUE(
      parse("# .PCD v.7 - Point Cloud Data file format\n"
            "VERSION .7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n"
            "WIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ascii\n"
            "0.93773 0.33763 0 4.2108e+06\n"
            "\n"
            "  +0.90805\t-0.35641 nan 4.2108e+06  \n"
            "inf 0.32 1e-50 oops",
            cloud));
  EXPECT_EQ(cloud.x[0], 0.93773F);
  EXPECT_EQ(cloud.x[1], 0.90805F);
  EXPECT_EQ(cloud.y[1], -0.35641F);
  EXPECT_TRUE(std::isnan(cloud.z[1]));
  EXPECT_TRUE(std::isinf(cloud.x[2]));
  EXPECT_EQ(cloud.z[2], 0.0F);
  EXPECT_FALSE(cloud.has_intensity() || cloud.has_ring() || cloud.has_time());
}

TEST(Pcd, ReadsKnownBytes) {
  // One record: u8 pad[3], f64 x, f32 y, i16 z, u8 intensity, u32 time_stamp.
  std::string text =
      "VERSION 0.7\nFIELDS _ x y z intensity time_stamp\nSIZE 1 8 4 2 1 4\nTYPE U F F I U U\n"
      "COUNT 3 1 1 1 1 1\nWIDTH 1\nHEIGHT 2\nPOINTS 2\nDATA binary\n";
  const std::string first(
      "\xAA\xBB\xCC"
      "\0\0\0\0\0\0\xF8\x3F"
      "\0\0\x20\xC0"
      "\xFE\xFF"
      "\xC8"
      "\xE8\x03\0\0",
      22);
  const std::string second(
      "\xAA\xBB\xCC"
      "\0\0\0\0\0\0\0\xC0"
      "\0\0\x80\x3F"
      "\x07\0"
      "\x01"
      "\0\0\0\xFF",
      22);
  PointCloud cloud;
  ASSERT_TRUE(parse(text + first + second + "what follows does not count", cloud));
  EXPECT_EQ(cloud.x, (std::vector{1.5F, -2.0F}));
  EXPECT_EQ(cloud.y, (std::vector{-2.5F, 1.0F}));
  EXPECT_EQ(cloud.z, (std::vector{-2.0F, 7.0F}));
  EXPECT_EQ(cloud.intensity, (std::vector{200.0F, 1.0F}));
  EXPECT_EQ(cloud.time_ns, (std::vector<std::int64_t>{0, 0xFF000000LL - 1000}));
  expect_error(parse(text + first + second.substr(0, 21)), ErrorCode::truncated, "record 2 of 2");
}

TEST(Pcd, ReadsKnownCompressedBytes) {
  // Literal runs alone, as LZF has them: a byte (length - 1), then the bytes. Columns: x x y y z z.
  const std::string columns(
      "\0\0\x80\x3F"
      "\0\0\0\x40"
      "\0\0\x40\x40"
      "\0\0\x80\x40"
      "\0\0\xA0\x40"
      "\0\0\xC0\x40",
      24);
  const std::string header = kHeader + "DATA binary_compressed\n";
  const std::string body = std::string(
                               "\x19\0\0\0"
                               "\x18\0\0\0"
                               "\x17",
                               9) +
                           columns;
  PointCloud cloud;
  ASSERT_TRUE(parse(header + body, cloud));
  EXPECT_EQ(cloud.x, (std::vector{1.0F, 2.0F}));
  EXPECT_EQ(cloud.y, (std::vector{3.0F, 4.0F}));
  EXPECT_EQ(cloud.z, (std::vector{5.0F, 6.0F}));

  std::string wrong_size = body;
  wrong_size[4] = '\x17';
  expect_error(parse(header + wrong_size), ErrorCode::corrupt, "announces 23 bytes");
  std::string wrong_code = body;
  wrong_code[8] = '\x16';
  expect_error(parse(header + wrong_code), ErrorCode::corrupt, "is damaged");
  expect_error(parse(header + body.substr(0, 20)), ErrorCode::truncated, "cut short");
  expect_error(parse(header + "\x01"), ErrorCode::truncated, "cut short");
  expect_error(parse("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 16777216\n"
                     "DATA binary_compressed\n" +
                     std::string("\x01\0\0\0"
                                 "\0\0\0\x0C"
                                 "\0",
                                 9)),
               ErrorCode::corrupt, "has 1 bytes, too few for the 201326592");
}

TEST(Pcd, ReadsOddHeaders) {
  PointCloud cloud;
  // CR LF, COLUMNS, no COUNT, HEIGHT or POINTS, upper-case names, a comment within.
  ASSERT_TRUE(
      parse("VERSION .5\r\nCOLUMNS Z Y X Ring\r\n# more\r\nSIZE 4 4 4 2\r\n"
            "TYPE F F F U\r\nWIDTH 2\r\nDATA ascii\r\n1 2 3 4\r\n5 6 7 8\r\n",
            cloud));
  EXPECT_EQ(cloud.x, (std::vector{3.0F, 7.0F}));
  EXPECT_EQ(cloud.z, (std::vector{1.0F, 5.0F}));
  EXPECT_EQ(cloud.ring, (std::vector<std::uint16_t>{4, 8}));
  ASSERT_TRUE(parse("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3", cloud));
  EXPECT_EQ(cloud.size(), 1U);
  ASSERT_TRUE(
      parse("VERSION .7\r\nFIELDS x y z\r\nSIZE 4 4 4\r\nTYPE F F F\r\nWIDTH 1\r\n"
            "DATA binary\r\n" +
                std::string(12, '\0'),
            cloud));
  EXPECT_EQ(cloud.x[0], 0.0F);
}

TEST(Pcd, FlattensOrganisedClouds) {
  PointCloud cloud;
  ASSERT_TRUE(
      parse("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 2\nPOINTS 4\n"
            "DATA ascii\n1 0 0\n2 0 0\nnan nan nan\n4 0 0\n",
            cloud));
  ASSERT_EQ(cloud.size(), 4U);
  EXPECT_TRUE(std::isnan(cloud.x[2]));
  EXPECT_EQ(cloud.x[3], 4.0F);
}

TEST(Pcd, PrefersTheFirstNameOfAColumnAndTheFirstOfItsNumbers) {
  PointCloud cloud;
  ASSERT_TRUE(parse(one_point("i x y z reflectivity intensity laser_id channel", "4 4 4 4 4 4 2 2",
                              "F F F F F F U U", "1 2 1 1 1 1 1 1", "9 1 99 2 3 8 7 21 22\n"),
                    cloud));
  EXPECT_EQ(cloud.x, std::vector{1.0F});
  EXPECT_EQ(cloud.intensity, std::vector{7.0F});
  EXPECT_EQ(cloud.ring, std::vector<std::uint16_t>{22});
}

TEST(Pcd, MakesTimesRelativeToTheFirst) {
  const std::string head = "FIELDS x y z t\nSIZE 4 4 4 8\nTYPE F F F ";
  const std::string tail = "\nWIDTH 3\nDATA ascii\n";
  PointCloud cloud;
  ASSERT_TRUE(
      parse(head + "F" + tail + "0 0 0 1700000000.5\n0 0 0 1700000000.25\n0 0 0 nan\n", cloud));
  EXPECT_EQ(cloud.time_ns, (std::vector<std::int64_t>{250'000'000, 0, 0}));
  ASSERT_TRUE(parse(head + "U" + tail +
                        "0 0 0 1700000000000000123\n0 0 0 1700000000000000000\n"
                        "0 0 0 1700000000100000000\n",
                    cloud));
  EXPECT_EQ(cloud.time_ns, (std::vector<std::int64_t>{123, 0, 100'000'000}));
  ASSERT_TRUE(parse(head + "I" + tail + "0 0 0 -5\n0 0 0 7\n0 0 0 0\n", cloud));
  EXPECT_EQ(cloud.time_ns, (std::vector<std::int64_t>{0, 12, 5}));
  expect_error(parse(head + "I" + tail +
                     "0 0 0 -9223372036854775808\n0 0 0 9223372036854775807\n"
                     "0 0 0 0\n"),
               ErrorCode::corrupt, "292 years");
  expect_error(parse(head + "F" + tail + "0 0 0 0\n0 0 0 1e300\n0 0 0 0\n"), ErrorCode::corrupt,
               "292 years");
  expect_error(parse(head + "F" + tail + "0 0 0 inf\n0 0 0 inf\n0 0 0 inf\n"), ErrorCode::corrupt,
               "292 years");
  expect_error(parse("FIELDS x y z t\nSIZE 1 1 1 8\nTYPE U U U U\nWIDTH 1\nDATA binary\n" +
                     std::string(3, '\1') + std::string(8, '\xFF')),
               ErrorCode::corrupt, "2^63");
}

TEST(Pcd, NamesTheLineAtFault) {
  const std::string header = kHeader + "DATA ascii\n";  // seven lines
  expect_error(parse(header + "1 2 3\n4 5\n"), ErrorCode::corrupt, "line 9: fewer numbers");
  expect_error(parse(header + "1 2 3 4\n5 6 7\n"), ErrorCode::corrupt, "line 8: more numbers");
  expect_error(parse(header + "1 2 3\n4 5,5 6\n"), ErrorCode::corrupt, "line 9: '5,5' is not");
  expect_error(parse(header + "1 2 1e999\n4 5 6\n"), ErrorCode::corrupt, "'1e999' is not");
  expect_error(parse(header + "1 2 +-3\n4 5 6\n"), ErrorCode::corrupt, "'+-3' is not a number");
  expect_error(parse(header + "1 2 3\n"), ErrorCode::truncated, "record 2 of 2");
  expect_error(parse(header + "1 2 3\n4 5 6\n7 8 9\n"), ErrorCode::corrupt, "more points");
  const auto ring = [](const char* value, const char* type) {
    return parse(one_point("x y z ring", "4 4 4 4", std::string("F F F ") + type, "1 1 1 1",
                           std::string("0 0 0 ") + value));
  };
  expect_error(ring("-1", "I"), ErrorCode::corrupt, "a ring outside");
  expect_error(ring("65536", "I"), ErrorCode::corrupt, "a ring outside");
  expect_error(ring("1.5", "I"), ErrorCode::corrupt, "not an integer");
  expect_error(ring("inf", "F"), ErrorCode::corrupt, "a ring outside");
  EXPECT_TRUE(ring("nan", "F"));
  EXPECT_TRUE(ring("65535", "F"));
}

TEST(Pcd, RefusesDamagedHeaders) {
  const auto with = [](std::string_view from, std::string_view to) {
    std::string text =
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
        "POINTS 1\nDATA ascii\n1 2 3\n";
    text.replace(text.find(from), from.size(), to);
    return parse(text);
  };
  EXPECT_TRUE(with("VERSION", "VERSION"));
  expect_error(with("FIELDS x y z", "FIELDS x y w"), ErrorCode::unsupported, "no field 'z'");
  expect_error(with("FIELDS x y z", "FIELDS x y"), ErrorCode::corrupt, "an entry for each field");
  expect_error(with("FIELDS x y z\n", ""), ErrorCode::corrupt, "an entry for each field");
  expect_error(with("COUNT 1 1 1", "COUNT 1 1"), ErrorCode::corrupt, "an entry for each field");
  expect_error(with("COUNT 1 1 1", "COUNT 1 1 0"), ErrorCode::corrupt, "field 'z'");
  expect_error(with("COUNT 1 1 1", "COUNT 1 1 5000"), ErrorCode::corrupt, "field 'z'");
  expect_error(with("SIZE 4 4 4", "SIZE 4 3 4"), ErrorCode::corrupt, "field 'y'");
  expect_error(with("TYPE F F F", "TYPE F F X"), ErrorCode::corrupt, "field 'z'");
  expect_error(with("SIZE 4 4 4", "SIZE 4 4 2"), ErrorCode::corrupt, "field 'z'");
  expect_error(with("HEIGHT 1", "HEIGHT 2"), ErrorCode::corrupt, "1 x 2 points");
  expect_error(with("WIDTH 1", "WIDTH -1"), ErrorCode::corrupt, "line 6");
  expect_error(with("HEIGHT 1", "HIGHT 1"), ErrorCode::corrupt, "line 7");
  expect_error(with("POINTS 1", "POINTS many"), ErrorCode::corrupt, "line 8");
  expect_error(with("WIDTH 1\nHEIGHT 1\nPOINTS 1\n", ""), ErrorCode::corrupt, "neither WIDTH");
  expect_error(with("WIDTH 1\nHEIGHT 1\nPOINTS 1\n", "WIDTH 16777217\n"), ErrorCode::limit,
               "16777216");
  expect_error(with("WIDTH 1\nHEIGHT 1\nPOINTS 1\n", "WIDTH 16777216\nHEIGHT 2\n"),
               ErrorCode::limit, "16777216");
  expect_error(with("WIDTH 1\nHEIGHT 1\nPOINTS 1\n", "POINTS 18446744073709551615\n"),
               ErrorCode::limit, "16777216");
  expect_error(with("WIDTH 1\nHEIGHT 1\nPOINTS 1\n", "WIDTH 9999999\n"), ErrorCode::truncated,
               "9999999 points");
  expect_error(with("DATA ascii", "DATA zip"), ErrorCode::unsupported, "DATA is neither");
  expect_error(with("DATA ascii\n1 2 3\n", ""), ErrorCode::truncated, "within the PCD header");
  expect_error(parse("x,y,z\n1,2,3\n"), ErrorCode::unsupported, "not a PCD file");
}

TEST(Pcd, WritesWhatOthersRead) {
  PointCloud cloud;
  cloud.x = {1.5F, -2.0F};
  cloud.y = {0.1F, 3.0F};
  cloud.z = {0.0F, -0.25F};
  cloud.intensity = {0.5F, 1.0F};
  cloud.ring = {3, 127};
  cloud.time_ns = {0, 1'234'567};
  std::vector<std::byte> bytes;
  serialize_pcd(cloud, CloudEncoding::ascii, bytes);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()),
            "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
            "FIELDS x y z intensity ring time\nSIZE 4 4 4 4 2 8\nTYPE F F F F U F\n"
            "COUNT 1 1 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\n"
            "DATA ascii\n1.5 0.1 0 0.5 3 0\n-2 3 -0.25 1 127 0.001234567\n");
}

}  // namespace
}  // namespace sweepcast
