#include "sweepcast/cloud.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace sweepcast {
namespace {

/// A record that holds one value at an odd offset.
template <class T>
std::vector<std::byte> records_of(const std::vector<T>& values, std::size_t step,
                                  std::size_t offset) {
  std::vector<std::byte> bytes(step * values.size(), std::byte{0xA5});
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::memcpy(bytes.data() + i * step + offset, &values[i], sizeof(T));
  }
  return bytes;
}

template <class T>
void expect_reads_back(ScalarType type) {
  using Limits = std::numeric_limits<T>;
  EXPECT_EQ(size_of(type), sizeof(T));
  const std::vector<T> values{T{0}, T{1}, static_cast<T>(100), Limits::lowest(), Limits::max()};
  const auto bytes = records_of(values, 13, 3);
  const FieldView view = CloudView::field(bytes, 13, {3, type});
  ASSERT_TRUE(view.present());
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(view.at(i), static_cast<double>(values[i])) << "value " << i;
  }
  std::array<float, 2> read{};
  view.read(1, read);
  EXPECT_EQ(read, (std::array<float, 2>{1.0F, 100.0F}));
}

TEST(FieldView, ReadsEveryScalarTypeUnaligned) {
  expect_reads_back<std::int8_t>(ScalarType::i8);
  expect_reads_back<std::uint8_t>(ScalarType::u8);
  expect_reads_back<std::int16_t>(ScalarType::i16);
  expect_reads_back<std::uint16_t>(ScalarType::u16);
  expect_reads_back<std::int32_t>(ScalarType::i32);
  expect_reads_back<std::uint32_t>(ScalarType::u32);
  expect_reads_back<std::int64_t>(ScalarType::i64);
  expect_reads_back<float>(ScalarType::f32);
  expect_reads_back<double>(ScalarType::f64);
}

TEST(FieldView, ScalesWhatItReads) {
  const auto bytes = records_of(std::vector<double>{0.0, 0.25, 0.1}, 8, 0);
  const FieldView seconds = CloudView::field(bytes, 8, {0, ScalarType::f64}, 1e9);
  EXPECT_EQ(seconds.at(1), 2.5e8);
  const auto floats = records_of(std::vector<float>{1.0F, 3.0F}, 4, 0);
  std::array<float, 2> read{};
  CloudView::field(floats, 4, {0, ScalarType::f32}, 0.5).read(0, read);
  EXPECT_EQ(read, (std::array<float, 2>{0.5F, 1.5F}));
}

template <class Scalar>
void expect_structs_work() {
  struct Point {
    char tag;
    Scalar x, y, z;
    int extra;
  };
  const std::vector<Point> points{{'a', 1, 2, 3, 0}, {'b', -4, 5.5, 6, 0}};
  const auto view = CloudView::structs<Point>(points, &Point::x, &Point::y, &Point::z);
  ASSERT_EQ(view.size, 2U);
  EXPECT_EQ(view.x.at(1), -4.0);
  EXPECT_EQ(view.y.at(1), 5.5);
  EXPECT_EQ(view.z.at(0), 3.0);
  EXPECT_FALSE(view.intensity.present());
  EXPECT_EQ(CloudView::structs<Point>({}, &Point::x, &Point::y, &Point::z).size, 0U);
}

TEST(CloudView, OfStructs) {
  expect_structs_work<float>();
  expect_structs_work<double>();
}

TEST(CloudView, OfRecordsLikePointCloud2) {
  // u8, then x y z as float at 1, 5, 9, ring as u16 at 13, time as u32 at 15: 19 bytes a point.
  std::vector<std::byte> data(3 * 19 + 5);  // the last record is cut and does not count
  for (std::size_t i = 0; i < 3; ++i) {
    const std::array<float, 3> xyz{static_cast<float>(i), static_cast<float>(i) + 0.5F, -1.0F};
    const auto ring = static_cast<std::uint16_t>(60000 + i);
    const auto time = static_cast<std::uint32_t>(4'000'000'000U + i);
    std::memcpy(data.data() + i * 19 + 1, xyz.data(), 12);
    std::memcpy(data.data() + i * 19 + 13, &ring, 2);
    std::memcpy(data.data() + i * 19 + 15, &time, 4);
  }
  CloudView view = CloudView::records(data, 19, {1}, {5}, {9});
  view.ring = CloudView::field(data, 19, {13, ScalarType::u16});
  view.time_ns = CloudView::field(data, 19, {15, ScalarType::u32});
  ASSERT_EQ(view.size, 3U);
  std::array<float, 2> y{};
  view.y.read(1, y);
  EXPECT_EQ(y, (std::array<float, 2>{1.5F, 2.5F}));
  EXPECT_EQ(view.z.at(2), -1.0);
  EXPECT_EQ(view.ring.at(2), 60002.0);
  EXPECT_EQ(view.time_ns.at(1), 4'000'000'001.0);
  EXPECT_EQ(CloudView::records(data, 0, {1}, {5}, {9}).size, 0U);
  // Fields that reach beyond a record would be read from the next one, or past the data.
  EXPECT_TRUE(CloudView::field(data, 19, {15}).present());
  EXPECT_FALSE(CloudView::field(data, 19, {16}).present());
  EXPECT_FALSE(CloudView::field(data, 19, {1000, ScalarType::u8}).present());
}

TEST(CloudView, OfColumnsAndOfAPointCloud) {
  PointCloud cloud;
  cloud.x = {1, 2};
  cloud.y = {3, 4};
  cloud.z = {5, 6};
  cloud.ring = {7, 8};
  cloud.time_ns = {0, 9};
  const CloudView view = cloud;
  EXPECT_EQ(view.size, 2U);
  EXPECT_EQ(view.z.at(1), 6.0);
  EXPECT_EQ(view.ring.at(0), 7.0);
  EXPECT_EQ(view.time_ns.at(1), 9.0);
  EXPECT_FALSE(view.intensity.present());
  const CloudView columns = CloudView::columns(cloud.x, cloud.y, cloud.z);
  EXPECT_EQ(columns.size, 2U);
  EXPECT_EQ(columns.y.at(1), 4.0);
  EXPECT_FALSE(columns.ring.present());
  EXPECT_EQ(CloudView(PointCloud{}).size, 0U);
}

TEST(PointCloud, ClearKeepsTheMemory) {
  PointCloud cloud;
  cloud.resize_xyz(1000);
  cloud.intensity.resize(1000);
  EXPECT_EQ(cloud.size(), 1000U);
  EXPECT_TRUE(cloud.has_intensity());
  const float* memory = cloud.x.data();
  cloud.clear();
  EXPECT_TRUE(cloud.empty());
  EXPECT_FALSE(cloud.has_intensity());
  cloud.resize_xyz(1000);
  EXPECT_EQ(cloud.x.data(), memory);
}

}  // namespace
}  // namespace sweepcast
