#include "codec/rcpcc/unfit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "codec/rcpcc/images.hpp"

namespace sweepcast::rcpcc {
namespace {

using test::image_of;
using test::thin;
using test::uniform;

using Mask = std::vector<std::uint8_t>;

std::vector<std::byte> written(const RangeImage& image, const Mask& fitted,
                               const UnfitOptions& options) {
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  UnfitCoder().write(image, fitted, options, out);
  return bytes;
}

/// Codes the cells of `image` that are not fitted; the decoder knows the others and the mask.
RangeImage round_trip(const RangeImage& image, const Mask& fitted, const UnfitOptions& options) {
  const auto bytes = written(image, fitted, options);
  RangeImage decoded = image;
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    if (decoded.range_mm[i] != 0 && fitted[i] == 0) decoded.range_mm[i] = 1;
  }
  ByteReader in(bytes);
  EXPECT_TRUE(UnfitCoder().read(in, fitted, options, decoded));
  EXPECT_TRUE(in.at_end());
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    if (image.range_mm[i] == 0 || fitted[i] != 0) {
      EXPECT_EQ(decoded.range_mm[i], image.range_mm[i]);
    } else {
      EXPECT_GT(decoded.range_mm[i], 0);
    }
  }
  return decoded;
}

/// Root mean square error, millimetres, of the unfit cells of each region.
std::map<std::pair<int, int>, double> rms_by_region(const RangeImage& a, const RangeImage& b,
                                                    const Mask& fitted, int region_size) {
  std::map<std::pair<int, int>, std::pair<double, int>> sums;
  for (int row = 0; row < a.grid.rows; ++row) {
    for (int col = 0; col < a.grid.cols; ++col) {
      const auto cell = static_cast<std::size_t>(&a.row(row)[col] - a.range_mm.data());
      if (a.range_mm[cell] == 0 || fitted[cell] != 0) continue;
      auto& [squares, count] = sums[{row / region_size, col / region_size}];
      squares += std::pow(a.range_mm[cell] - b.range_mm[cell], 2);
      ++count;
    }
  }
  std::map<std::pair<int, int>, double> rms;
  for (const auto& [region, sum] : sums) rms[region] = std::sqrt(sum.first / sum.second);
  return rms;
}

double mean_square(const RangeImage& a, const RangeImage& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.range_mm.size(); ++i) {
    sum += std::pow(a.range_mm[i] - b.range_mm[i], 2);
  }
  return sum / static_cast<double>(a.range_mm.size());
}

struct Scene {
  RangeImage image;
  Mask fitted;
};

Scene random_scene(std::mt19937& random, bool smooth) {
  Scene scene{image_of(37, 75,
                       [&](int row, int col) {
                         return smooth ? 20 + 0.1 * row + 5 * std::sin(0.1 * col) +
                                             uniform(random, -0.05, 0.05)
                                       : uniform(random, 3, 120);
                       }),
              {}};
  thin(scene.image, random, 0.4);
  for (std::size_t i = 0; i < scene.image.range_mm.size(); ++i) {
    scene.fitted.push_back(scene.image.range_mm[i] != 0 && uniform(random, 0, 1) < 0.5 ? 1 : 0);
  }
  return scene;
}

TEST(Unfit, ErrorOfEveryRegionIsWithinHalfAStep) {
  // The transform is orthonormal, so the coefficients' errors are those of the ranges.
  std::mt19937 random(1);
  for (const int region_size : {4, 8, 16, 32}) {
    for (const std::int32_t step : {1, 20, 100, 400, 1000}) {
      for (const bool smooth : {true, false}) {
        const Scene scene = random_scene(random, smooth);
        const UnfitOptions options{region_size, step, UnfitCoding::sa_dct, Rounding::nearest};
        const RangeImage decoded = round_trip(scene.image, scene.fitted, options);
        for (const auto& [region, rms] :
             rms_by_region(scene.image, decoded, scene.fitted, region_size)) {
          // Half a millimetre for rounding to whole ones, and float sums of large ranges.
          EXPECT_LE(rms, 0.5 * step + 0.5 + (region_size == 32 ? 0.2 : 0.05));
        }
      }
    }
  }
}

TEST(Unfit, TruncationIsWorseThanRounding) {
  std::mt19937 random(2);
  for (const int region_size : {4, 8, 16, 32}) {
    const Scene scene = random_scene(random, false);
    UnfitOptions options{region_size, 200, UnfitCoding::sa_dct, Rounding::nearest};
    const double nearest = mean_square(scene.image, round_trip(scene.image, scene.fitted, options));
    options.rounding = Rounding::truncate;
    const double truncated =
        mean_square(scene.image, round_trip(scene.image, scene.fitted, options));
    // Uniform errors over a step: 1/3 against 1/12 of its square.
    EXPECT_NEAR(truncated / nearest, 4.0, 0.5) << region_size;
  }
}

TEST(Unfit, RawRangesAreExact) {
  std::mt19937 random(3);
  for (const int region_size : {4, 8, 16, 32}) {
    for (const bool smooth : {true, false}) {
      const Scene scene = random_scene(random, smooth);
      const UnfitOptions options{region_size, 200, UnfitCoding::raw, Rounding::nearest};
      EXPECT_EQ(round_trip(scene.image, scene.fitted, options).range_mm, scene.image.range_mm);
    }
  }
}

TEST(Unfit, RangesAtTheExtremesStayPositive) {
  const Mask none(32, 0);
  for (const UnfitCoding coding : {UnfitCoding::sa_dct, UnfitCoding::raw}) {
    for (const std::int32_t step : {1, 10000}) {
      const UnfitOptions options{4, step, coding, Rounding::nearest};
      RangeImage image =
          image_of(4, 8, [](int row, int col) { return (row + col) % 2 == 0 ? 0.001 : 1000.0; });
      round_trip(image, none, options);  // checks that every range is above 0
    }
  }
}

TEST(Unfit, NothingUnfitTakesNoByte) {
  const RangeImage image = image_of(8, 8, [](int, int) { return 5.0; });
  const Mask all(64, 1);
  EXPECT_TRUE(written(image, all, {}).empty());
  EXPECT_TRUE(written(test::empty_image(8, 8), Mask(64, 0), {}).empty());
}

TEST(Unfit, SmoothRegionsTakeFewerBytesThanNoise) {
  std::mt19937 random(4);
  const auto zeros = [](const std::vector<std::byte>& bytes) {
    return std::count(bytes.begin(), bytes.end(), std::byte{0});
  };
  const Scene smooth = random_scene(random, true);
  Scene noise = random_scene(random, false);
  EXPECT_GT(zeros(written(smooth.image, smooth.fitted, {})),
            5 * zeros(written(noise.image, noise.fitted, {})));
}

TEST(Unfit, RejectsBytesThatEndEarlyOrCannotBe) {
  std::mt19937 random(5);
  const Scene scene = random_scene(random, false);
  for (const UnfitCoding coding : {UnfitCoding::sa_dct, UnfitCoding::raw}) {
    const UnfitOptions options{8, 100, coding, Rounding::nearest};
    const auto bytes = written(scene.image, scene.fitted, options);
    RangeImage decoded = scene.image;
    for (std::size_t size = 0; size < bytes.size(); size += 97) {
      ByteReader in{std::span(bytes).first(size)};
      EXPECT_FALSE(UnfitCoder().read(in, scene.fitted, options, decoded)) << size;
    }
    // A first range below zero, and one of 4000 km.
    for (const std::int64_t range : {std::int64_t{-1}, std::int64_t{2'000'000'000}}) {
      std::vector<std::byte> damaged;
      ByteWriter out(damaged);
      out.put(std::uint8_t{255});
      const auto zigzag = static_cast<std::uint64_t>(range < 0 ? -2 * range - 1 : 2 * range);
      if (zigzag < 255) {
        damaged.assign(1, static_cast<std::byte>(zigzag));
      } else {
        out.put_varint(zigzag - 255);
      }
      damaged.insert(damaged.end(), bytes.begin(), bytes.end());
      ByteReader in(damaged);
      EXPECT_FALSE(UnfitCoder().read(in, scene.fitted, options, decoded)) << range;
    }
  }
}

}  // namespace
}  // namespace sweepcast::rcpcc
