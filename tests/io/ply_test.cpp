// PLY as others write it.
#include "io/formats.hpp"
#include "io/support.hpp"

namespace sweepcast {
namespace {

using test::bytes_of;
using test::expect_error;

Status parse(std::string_view text, PointCloud& cloud) {
  return parse_ply(bytes_of(text), cloud);
}

Status parse(std::string_view text) {
  PointCloud cloud;
  return parse(text, cloud);
}

const std::string kVertex =
    "element vertex 2\nproperty float x\nproperty float y\nproperty float z\n";

TEST(Ply, ReadsTextWithElementsAround) {
  PointCloud cloud;
  ASSERT_TRUE(
      parse("ply\nformat ascii 1.0\ncomment made by hand\nobj_info nothing\n"
            "element camera 1\nproperty float view_px\nproperty list uchar int seen\n"
            "element vertex 2\nproperty double x\nproperty float32 y\nproperty int16 z\n"
            "property list uchar float weights\nproperty uchar scalar_Intensity\n"
            "property ushort ring\nproperty uint t\n"
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
            "0.5 3 1 2 3\n"
            "1 2 3 2 0.5 0.5 200 7 1000\n"
            "-1 -2 -3 0 100 8 3000\n"
            "3 0 1 0\n",
            cloud));
  EXPECT_EQ(cloud.x, (std::vector{1.0F, -1.0F}));
  EXPECT_EQ(cloud.y, (std::vector{2.0F, -2.0F}));
  EXPECT_EQ(cloud.z, (std::vector{3.0F, -3.0F}));
  EXPECT_EQ(cloud.intensity, (std::vector{200.0F, 100.0F}));
  EXPECT_EQ(cloud.ring, (std::vector<std::uint16_t>{7, 8}));
  EXPECT_EQ(cloud.time_ns, (std::vector<std::int64_t>{0, 2000}));
}

TEST(Ply, ReadsKnownBytesOfBothOrders) {
  // A face of list length u8 and indices i32 before the vertices; a list within them.
  const std::string elements =
      "element face 1\nproperty list uchar int vertex_indices\nelement vertex 1\n"
      "property float x\nproperty list ushort uchar tags\nproperty double y\nproperty short z\n"
      "end_header\n";
  const std::string little(
      "\x02"
      "\1\0\0\0"
      "\2\0\0\0"
      "\0\0\xC0\x3F"
      "\3\0"
      "\7\7\7"
      "\0\0\0\0\0\0\4\xC0"
      "\xFE\xFF",
      28);
  const std::string big(
      "\x02"
      "\0\0\0\1"
      "\0\0\0\2"
      "\x3F\xC0\0\0"
      "\0\3"
      "\7\7\7"
      "\xC0\4\0\0\0\0\0\0"
      "\xFF\xFE",
      28);
  for (const bool is_big : {false, true}) {
    const std::string header = std::string("ply\nformat binary_") + (is_big ? "big" : "little") +
                               "_endian 1.0\n" + elements;
    PointCloud cloud;
    ASSERT_TRUE(parse(header + (is_big ? big : little), cloud));
    EXPECT_EQ(cloud.x, std::vector{1.5F});
    EXPECT_EQ(cloud.y, std::vector{-2.5F});
    EXPECT_EQ(cloud.z, std::vector{-2.0F});
    for (std::size_t size = 0; size < big.size(); ++size) {
      expect_error(parse(header + (is_big ? big : little).substr(0, size)), ErrorCode::truncated,
                   "data ends");
    }
  }
}

TEST(Ply, ReadsHeadersWithCarriageReturns) {
  PointCloud cloud;
  ASSERT_TRUE(
      parse("ply\r\nformat ascii 1.0\r\nelement vertex 1\r\nproperty float x\r\n"
            "property float y\r\nproperty float z\r\nend_header\r\n1 2 3\r\n",
            cloud));
  EXPECT_EQ(cloud.z, std::vector{3.0F});
}

TEST(Ply, RefusesDamagedHeaders) {
  const auto with = [](const std::string& lines) {
    return parse("ply\n" + lines + "end_header\n1 2 3\n4 5 6\n");
  };
  const std::string format = "format ascii 1.0\n";
  EXPECT_TRUE(with(format + kVertex));
  expect_error(with(kVertex), ErrorCode::corrupt, "no line 'format'");
  expect_error(with("format ascii 2.0\n"), ErrorCode::corrupt, "line 2");
  expect_error(with("format utf8 1.0\n"), ErrorCode::corrupt, "line 2");
  expect_error(with(format + "property float x\n"), ErrorCode::corrupt, "line 3");
  expect_error(with(format + "element vertex\n"), ErrorCode::corrupt, "line 3");
  expect_error(with(format + "element vertex -2\n"), ErrorCode::corrupt, "line 3");
  expect_error(with(format + kVertex + "property complex w\n"), ErrorCode::corrupt, "line 7");
  expect_error(with(format + kVertex + "property float\n"), ErrorCode::corrupt, "line 7");
  expect_error(with(format + kVertex + "property list float int w\n"), ErrorCode::corrupt,
               "line 7");
  expect_error(with(format + kVertex + "property list uchar w\n"), ErrorCode::corrupt, "line 7");
  expect_error(with(format + kVertex + "poperty int w\n"), ErrorCode::corrupt, "line 7");
  expect_error(with(format + "element face 0\n"), ErrorCode::unsupported, "no element 'vertex'");
  expect_error(with(format + "element vertex 2\nproperty float x\nproperty float y\n"),
               ErrorCode::unsupported, "no field 'z'");
  expect_error(with(format + "element vertex 2\nproperty list uchar float x\nproperty float y\n"
                             "property float z\n"),
               ErrorCode::unsupported, "no field 'x'");
  expect_error(with(format + "element vertex 16777217\nproperty float x\nproperty float y\n"
                             "property float z\n"),
               ErrorCode::limit, "16777217");
  expect_error(parse("ply\n" + format + kVertex), ErrorCode::truncated, "within the PLY header");
  expect_error(parse("plyx\n"), ErrorCode::unsupported, "not a PLY file");
}

TEST(Ply, RefusesDamagedData) {
  const std::string header = "ply\nformat ascii 1.0\n" + kVertex;  // six lines
  expect_error(parse(header + "end_header\n1 2 3\n4 five 6\n"), ErrorCode::corrupt, "line 9");
  expect_error(parse(header + "end_header\n1 2 3\n"), ErrorCode::truncated, "record 2 of 2");
  const std::string list = header + "property list char float w\nend_header\n";
  expect_error(parse(list + "1 2 3 -1\n1 2 3 0\n"), ErrorCode::corrupt, "negative length");
  expect_error(parse(list + "1 2 3 4 0 0\n1 2 3 0\n"), ErrorCode::corrupt, "fewer numbers");
  const std::string faces = "ply\nformat ascii 1.0\nelement face 3\nproperty list uchar int i\n";
  expect_error(parse(faces + kVertex + "end_header\n1 0\n1 0\n"), ErrorCode::truncated, "record 3");
}

TEST(Ply, PassesOverEmptyElementsOfAnyCount) {
  PointCloud cloud;
  ASSERT_TRUE(parse("ply\nformat ascii 1.0\nelement nothing 18446744073709551615\n" + kVertex +
                        "end_header\n1 2 3\n4 5 6\n",
                    cloud));
  EXPECT_EQ(cloud.size(), 2U);
  expect_error(parse("ply\nformat binary_little_endian 1.0\nelement much 18446744073709551615\n"
                     "property uchar i\n" +
                     kVertex + "end_header\nshort"),
               ErrorCode::truncated, "record 6");
}

TEST(Ply, WritesWhatOthersRead) {
  PointCloud cloud;
  cloud.x = {1.5F};
  cloud.y = {0.1F};
  cloud.z = {-4.0F};
  cloud.ring = {65535};
  cloud.time_ns = {0};
  std::vector<std::byte> bytes;
  serialize_ply(cloud, CloudEncoding::ascii, bytes);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()),
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
            "property float z\nproperty ushort ring\nproperty double time\nend_header\n"
            "1.5 0.1 -4 65535 0\n");
}

}  // namespace
}  // namespace sweepcast
