#include "lab/peers/range_raster.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/points.hpp"
#include "core/random.hpp"
#include "lab/peers/mask_coder.hpp"

namespace sweepcast::lab {
namespace {

using test::add_point;
using test::random_bits;

/// Three rows from 1.7 degrees up to as much down, the lowest 10 cm below the sensor.
RangeRaster three_rows(std::size_t columns) {
  RangeRaster raster;
  raster.rows = {{2000, 0}, {0, 0}, {-2000, -100}};
  raster.columns = columns;
  return raster;
}

TEST(RangeRaster, APointGoesIntoItsRowAndColumn) {
  RangeRaster raster = three_rows(8);
  PointCloud cloud;
  add_point(cloud, 3.0, 3.0, 0.0);             // 45 degrees to the left: the border of 5 and 6 ...
  add_point(cloud, -10.0, -0.1, 0.305);        // just past the back: column 0, the top row
  add_point(cloud, 10.0, -0.1, -0.1 - 0.305);  // just right of the front: column 3, bottom row
  draw(cloud, raster);
  ASSERT_EQ(raster.ranges.size(), 24U);
  EXPECT_EQ(raster.unit_um, 2000U);
  EXPECT_EQ(raster.ranges[8 + 5], std::lround(std::sqrt(18.0) * 500));
  EXPECT_EQ(raster.ranges[0], std::lround(std::hypot(10.0, 0.1, 0.305) * 500));
  EXPECT_EQ(raster.ranges[16 + 3], std::lround(std::hypot(10.0, 0.1, 0.305) * 500));
}

TEST(RangeRaster, TheNearestOfACellStaysAndWhatHasNoRangeIsLeftOut) {
  RangeRaster raster = three_rows(4);
  PointCloud cloud;
  for (const float x : {5.0F, 4.0F, 6.0F}) add_point(cloud, x, x / 2, 0.0);
  add_point(cloud, 0.0, 0.0, 0.0);
  add_point(cloud, 1e30, 1.0, 0.0);
  add_point(cloud, std::numeric_limits<float>::quiet_NaN(), 1.0, 0.0);
  add_point(cloud, 1.0, 1.0, -std::numeric_limits<float>::infinity());
  draw(cloud, raster);
  PointCloud decoded;
  to_cloud(raster, 1, decoded);
  ASSERT_EQ(decoded.size(), 1U);
  EXPECT_NEAR(std::hypot(decoded.x[0], decoded.y[0]), 4.0 * std::sqrt(1.25), 0.0011);
}

TEST(RangeRaster, FarPointsMakeStepsCoarserAndStay) {
  RangeRaster raster = three_rows(4);
  PointCloud cloud;
  add_point(cloud, 600.0, 10.0, 0.0);
  draw(cloud, raster);
  PointCloud decoded;
  to_cloud(raster, 1, decoded);
  ASSERT_EQ(decoded.size(), 1U);
  EXPECT_NEAR(std::hypot(decoded.x[0], decoded.y[0]), std::hypot(600.0, 10.0), 0.005);
}

TEST(RangeRaster, GapsAreFilledAlongTheRow) {
  std::vector<std::uint16_t> ranges{0, 0, 10, 0, 0, 0, 2, 0,  //
                                    0, 0, 0,  0, 0, 0, 0, 0,  //
                                    5, 0, 0,  7, 0, 0, 0, 0};
  fill_gaps(8, ranges);
  EXPECT_EQ(ranges, (std::vector<std::uint16_t>{10, 10, 10, 8, 6, 4, 2, 2,  //
                                                10, 10, 10, 8, 6, 4, 2, 2,  //
                                                5,  5,  6,  7, 7, 7, 7, 7}));
}

TEST(RangeRaster, HeadsComeBackAndDamagedOnesAreRefused) {
  const RangeRaster raster = three_rows(1000);
  std::vector<std::byte> bytes;
  ByteWriter writer(bytes);
  write_head(raster, writer);
  RangeRaster read;
  ByteReader reader(bytes);
  ASSERT_TRUE(read_head(reader, read));
  EXPECT_EQ(read.columns, 1000U);
  ASSERT_EQ(read.rows.size(), 3U);
  EXPECT_EQ(read.rows[2].tan_elevation, -2000);
  EXPECT_EQ(read.rows[2].height_mm, -100);
  EXPECT_EQ(read.ranges.size(), 3000U);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ByteReader cut(std::span<const std::byte>(bytes).first(size));
    EXPECT_FALSE(read_head(cut, read)) << size;
  }
  for (const RasterRow& row : {RasterRow{1 << 30, 0}, RasterRow{0, 1 << 20}}) {
    RangeRaster steep = raster;
    steep.rows[1] = row;
    bytes.clear();
    write_head(steep, writer);
    ByteReader again(bytes);
    EXPECT_FALSE(read_head(again, read));
  }
}

TEST(MaskCoder, MasksComeBackAndRegularOnesAreSmall) {
  std::mt19937 random(5);
  std::vector<std::uint16_t> noise(64 * 500);
  std::vector<std::uint16_t> blocks(noise.size());
  for (std::size_t i = 0; i < noise.size(); ++i) {
    noise[i] = static_cast<std::uint16_t>(random_bits(random) % 2 * 7);
    blocks[i] = i % 500 / 100 % 2 == 0 ? 1 : 0;
  }
  for (const auto& [cells, most] : {std::pair{&noise, 4100U}, std::pair{&blocks, 150U}}) {
    std::vector<std::byte> bytes;
    encode_mask(*cells, 500, bytes);
    EXPECT_LT(bytes.size(), most);
    std::vector<std::uint8_t> decoded(cells->size(), 9);
    ASSERT_TRUE(decode_mask(bytes, 500, decoded));
    for (std::size_t i = 0; i < decoded.size(); ++i) {
      ASSERT_EQ(decoded[i] != 0, cells->at(i) != 0) << i;
    }
  }
  std::vector<std::byte> bytes;
  encode_mask(noise, 500, bytes);
  std::vector<std::uint8_t> decoded(noise.size());
  EXPECT_FALSE(decode_mask(std::span(bytes).first(100), 500, decoded));
}

}  // namespace
}  // namespace sweepcast::lab
