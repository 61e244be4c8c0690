#include "codec/rcpcc/surface.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "codec/rcpcc/images.hpp"
#include "lab/real_sweeps.hpp"

namespace sweepcast::rcpcc {
namespace {

using test::image_of;
using test::range_to_plane;
using test::thin;
using test::uniform;
using test::uniform_int;

struct Fitted {
  std::vector<Block> blocks;
  std::vector<Surface> surfaces;
  RangeImage painted;
  std::vector<std::uint8_t> fitted;
  std::size_t fitted_cells = 0;
};

/// Fits, writes, reads and paints as the codec does, and checks what must hold for any image.
Fitted fit(const RangeImage& image, const SurfaceOptions& options) {
  Fitted f;
  list_occupied_blocks(image, options.block_size, f.blocks);
  SurfaceFitter().fit(image, f.blocks, options, f.surfaces);

  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  write_surfaces(f.surfaces, out);
  std::vector<Surface> read;
  ByteReader in(bytes);
  EXPECT_TRUE(read_surfaces(in, f.blocks, read));
  EXPECT_TRUE(in.at_end());
  EXPECT_EQ(read, f.surfaces);

  f.painted = image;
  EXPECT_TRUE(paint_surfaces(f.surfaces, f.blocks, options, f.painted, f.fitted));
  EXPECT_EQ(f.fitted.size(), image.range_mm.size());
  for (std::size_t i = 0; i < f.fitted.size(); ++i) {
    if (f.fitted[i] == 0) {
      EXPECT_EQ(f.painted.range_mm[i], image.range_mm[i]);
      continue;
    }
    ++f.fitted_cells;
    EXPECT_NE(image.range_mm[i], 0) << "an empty cell was fitted";
    EXPECT_LE(std::abs(f.painted.range_mm[i] - image.range_mm[i]), options.threshold_mm);
  }
  std::uint32_t end = 0;
  for (const Surface& surface : f.surfaces) {
    EXPECT_GE(surface.first, end);
    EXPECT_GE(surface.length, 1U);
    end = surface.first + surface.length;
    if (end > f.blocks.size()) {
      ADD_FAILURE() << "a run beyond the blocks";
      break;
    }
    EXPECT_EQ(f.blocks[surface.first].row, f.blocks[end - 1].row);
  }
  return f;
}

/// Calls check(options) for both models, all block sizes and several thresholds.
template <class Check>
void for_all_options(Check check) {
  for (const SurfaceModel model : {SurfaceModel::surface, SurfaceModel::plane}) {
    for (const int block_size : {4, 8, 16}) {
      for (const std::int32_t threshold : {1, 4, 20, 100, 300, 2000, 10000}) {
        check(SurfaceOptions{block_size, threshold, model});
      }
    }
  }
}

std::size_t occupied_cells(const RangeImage& image) {
  std::size_t count = 0;
  for (const std::int32_t range : image.range_mm) count += range != 0 ? 1 : 0;
  return count;
}

TEST(Surface, ListsTheBlocksThatHoldAPoint) {
  RangeImage image = test::empty_image(9, 10);
  image.row(0)[9] = 1;
  image.row(8)[0] = 1;
  image.row(5)[5] = 1;
  std::vector<Block> blocks;
  list_occupied_blocks(image, 4, blocks);
  ASSERT_EQ(blocks.size(), 3U);
  const std::array<std::array<int, 2>, 3> expected{{{0, 2}, {1, 1}, {2, 0}}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(blocks[i].row, expected[i][0]);
    EXPECT_EQ(blocks[i].col, expected[i][1]);
  }
}

TEST(Surface, EveryFittedCellIsWithinTheThreshold) {
  std::mt19937 random(1);
  for_all_options([&](const SurfaceOptions& options) {
    // Sizes that are no multiple of the block's.
    RangeImage noise = image_of(21, 50, [&](int, int) { return uniform(random, 0.3, 120); });
    thin(noise, random, 0.3);
    fit(noise, options);

    RangeImage plane = image_of(37, 70, [&](int row, int col) {
      return range_to_plane(row, col, 0.8, 0.3, -0.2, 12) + uniform(random, -0.01, 0.01);
    });
    thin(plane, random, 0.2);
    const Fitted f = fit(plane, options);
    if (options.threshold_mm >= 100) {
      EXPECT_GT(f.fitted_cells, occupied_cells(plane) / 2);
    }

    RangeImage cylinder = image_of(30, 100, [](int, int col) {
      const double off = (col - 50) * 0.05;
      return std::abs(off) < 1 ? 8 - std::sqrt(1 - off * off) : 20.0;
    });
    fit(cylinder, options);

    RangeImage steps =
        image_of(30, 100, [](int row, int col) { return 5.0 + 3.0 * ((row / 5 + col / 7) % 4); });
    thin(steps, random, 0.1);
    fit(steps, options);

    RangeImage sparse = image_of(30, 100, [&](int, int) { return uniform(random, 1, 90); });
    thin(sparse, random, 0.95);
    fit(sparse, options);
  });
}

TEST(Surface, FitsWhateverTheRangesDo) {
  // Ranges of all magnitudes side by side, and slopes whose extrapolation runs to infinity.
  std::mt19937 random(2);
  for_all_options([&](const SurfaceOptions& options) {
    RangeImage wild =
        image_of(32, 64, [&](int, int) { return std::pow(10.0, uniform(random, -3, 3)); });
    thin(wild, random, uniform(random, 0, 0.9));
    fit(wild, options);
    for (int round = 0; round < 40; ++round) {
      const double pole_u = uniform(random, -10, 30);
      const double pole_v = uniform(random, -10, 30);
      const double a = uniform(random, -1, 1);
      RangeImage pole = image_of(20, 20, [&](int row, int col) {
        const double inverse = a * (col - pole_u) + (1 - std::abs(a)) * (row - pole_v);
        return inverse > 1e-6 ? std::min(1000.0, 3 / inverse) : 0.0;
      });
      thin(pole, random, 0.3);
      fit(pole, options);
    }
  });
}

TEST(Surface, ARealSweepIsWithinTheThreshold) {
  const auto sweeps = lab::real_sweeps("kitti_hdl64");
  if (sweeps.empty()) GTEST_SKIP() << "set SWEEPCAST_DATA to a folder with kitti_hdl64";
  const PointCloud cloud = lab::read_kitti(sweeps.front());
  RangeImage image;
  SweepCounts counts;
  SphericalProjector({}, {}).project(cloud, image, counts);
  for_all_options([&](const SurfaceOptions& options) {
    const Fitted f = fit(image, options);
    if (options.threshold_mm == 300 && options.block_size == 4) {
      EXPECT_GT(f.fitted_cells, counts.points_coded / 2);
    }
  });
}

TEST(Surface, APlaneInSpaceIsOneRunOfThePlaneModel) {
  // Two blocks wide: so far the rounding of the coefficients is bound to be within the threshold.
  std::mt19937 random(3);
  for (const int block_size : {4, 8, 16}) {
    for (const std::int32_t threshold : {100, 300}) {
      for (int round = 0; round < 20; ++round) {
        const double ny = uniform(random, -0.4, 0.4);
        const double nz = uniform(random, -0.4, 0.4);
        RangeImage image = image_of(2 * block_size, 2 * block_size, [&](int row, int col) {
          return range_to_plane(row, col, 1, ny, nz, 15);
        });
        const Fitted f = fit(image, {block_size, threshold, SurfaceModel::plane});
        EXPECT_EQ(f.surfaces.size(), 2U) << block_size << ", " << threshold;
        EXPECT_EQ(f.fitted_cells, occupied_cells(image));
      }
    }
  }
}

TEST(Surface, APlaneWithWholeCoefficientsIsOneRunHoweverWide) {
  // Cartesian: the axis of the first block's centre and its two tangents, in steps of 0.5 degrees.
  const double step = 0.5 * std::numbers::pi / 180;
  const double azimuth = -30 * std::numbers::pi / 180 + 2 * step;
  const double elevation = -10 * std::numbers::pi / 180 + 2 * step;
  const SurfaceSteps steps = SurfaceSteps::of(300, 4);
  const double r0 = 200 * steps.range / 1000;
  const double gu = -2 * steps.slope / 1000 / step;
  const double gv = 3 * steps.slope / 1000 / step;
  const auto along = [&](double axis, double tangent, double up) {
    return (r0 * axis + gu * tangent + gv * up) / (r0 * r0);
  };
  const double nx = along(std::cos(elevation) * std::cos(azimuth), -std::sin(azimuth),
                          -std::sin(elevation) * std::cos(azimuth));
  const double ny = along(std::cos(elevation) * std::sin(azimuth), std::cos(azimuth),
                          -std::sin(elevation) * std::sin(azimuth));
  const double nz = along(std::sin(elevation), 0, std::cos(elevation));
  const RangeImage image =
      image_of(4, 100, [&](int row, int col) { return range_to_plane(row, col, nx, ny, nz, 1); });
  const Fitted f = fit(image, {4, 300, SurfaceModel::plane});
  ASSERT_EQ(f.surfaces.size(), 1U);
  EXPECT_EQ(f.surfaces[0], (Surface{0, 25, {200, -2, 3}}));
  for (std::size_t i = 0; i < image.range_mm.size(); ++i) {
    EXPECT_NEAR(f.painted.range_mm[i], image.range_mm[i], 1);
  }
}

TEST(Surface, AHyperbolaIsOneRunOfTheSurfaceModel) {
  // r = -d / (a i + b j + c), the paper's equation 4, with slopes that are whole units.
  const SurfaceSteps steps = SurfaceSteps::of(300, 4);
  const double r0 = 160 * steps.range / 1000;
  const double gu = 2 * steps.slope / 1000;
  const RangeImage image =
      image_of(4, 40, [&](int, int col) { return r0 * r0 / (r0 + gu * (col - 1.5)); });
  const Fitted f = fit(image, {4, 300, SurfaceModel::surface});
  ASSERT_EQ(f.surfaces.size(), 1U);
  EXPECT_EQ(f.surfaces[0], (Surface{0, 10, {160, 2, 0}}));
  for (std::size_t i = 0; i < image.range_mm.size(); ++i) {
    EXPECT_NEAR(f.painted.range_mm[i], image.range_mm[i], 1);
  }
}

TEST(Surface, PointsInOneLineGiveFiniteCoefficients) {
  for_all_options([](const SurfaceOptions& options) {
    for (const bool in_column : {true, false}) {
      for (const double slope : {0.0, 0.001, 0.3}) {
        const RangeImage line = image_of(16, 16, [&](int row, int col) {
          return (in_column ? col : row) == 2 ? 10 + slope * (in_column ? row : col) : 0.0;
        });
        const Fitted f = fit(line, options);
        if (slope == 0.0 && options.threshold_mm >= 20) {
          EXPECT_EQ(f.fitted_cells, 16U) << options.threshold_mm;
        }
        if (options.model == SurfaceModel::plane) continue;
        for (const Surface& surface :
             f.surfaces) {  // the slope that the line does not tell is none
          EXPECT_EQ(in_column ? surface.coefficients.slope_u : surface.coefficients.slope_v, 0);
        }
      }
    }
    fit(image_of(16, 16, [](int row, int col) { return row == col ? 10.0 + row * 0.01 : 0.0; }),
        options);
  });
}

TEST(Surface, ABlockWhoseEmptyCentreExtrapolatesKilometresAwayCanBeRead) {
  const double r0 = 3000;
  const double gu = -11600;
  const RangeImage image = image_of(
      16, 16, [&](int, int col) { return col < 5 ? r0 * r0 / (r0 + gu * (col - 7.5)) : 0.0; });
  for_all_options([&](const SurfaceOptions& options) { fit(image, options); });
}

TEST(Surface, ALoneCellIsLeftToTheUnfitImage) {
  for_all_options([](const SurfaceOptions& options) {
    RangeImage image = test::empty_image(20, 20);
    image.row(19)[19] = 12345;
    EXPECT_TRUE(fit(image, options).surfaces.empty());
  });
}

TEST(Surface, OfNothingIsNothing) {
  EXPECT_TRUE(fit(test::empty_image(0, 720), {}).surfaces.empty());
  EXPECT_TRUE(fit(test::empty_image(12, 720), {}).surfaces.empty());
}

TEST(Surface, RandomListsRoundTrip) {
  std::mt19937 random(4);
  for (int round = 0; round < 200; ++round) {
    std::vector<Block> blocks;
    std::vector<Surface> surfaces;
    for (int row = 0; row < 10; ++row) {
      int left = uniform_int(random, 0, 1000);
      for (int col = 0; col < left; ++col) blocks.push_back({row, col});
      auto first = static_cast<std::uint32_t>(static_cast<int>(blocks.size()) - left);
      while (left > 0) {
        const int gap = uniform_int(random, 0, std::min(left - 1, 300));
        const int length = uniform_int(random, 1, std::min(left - gap, 400));
        first += static_cast<std::uint32_t>(gap);
        surfaces.push_back(
            {first,
             static_cast<std::uint32_t>(length),
             {uniform_int(random, 0, 2'000'000), uniform_int(random, -100'000'000, 100'000'000),
              uniform_int(random, -3, 3)}});
        first += static_cast<std::uint32_t>(length);
        left -= gap + length;
      }
    }
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    write_surfaces(surfaces, out);
    std::vector<Surface> read(3);
    ByteReader in(bytes);
    ASSERT_TRUE(read_surfaces(in, blocks, read));
    ASSERT_EQ(read, surfaces);
    for (const std::size_t size : {bytes.size() - 1, bytes.size() / 2, std::size_t{0}}) {
      ByteReader cut{std::span(bytes).first(surfaces.empty() ? 0 : size)};
      EXPECT_FALSE(read_surfaces(cut, blocks, read));
    }
  }
}

TEST(Surface, RejectsDamagedLists) {
  const std::vector<Block> blocks{{0, 0}, {0, 1}, {0, 5}, {1, 0}, {1, 1}};
  const auto is_read = [&](const std::vector<Surface>& surfaces) {
    std::vector<std::byte> bytes;
    ByteWriter out(bytes);
    write_surfaces(surfaces, out);
    ByteReader in(bytes);
    std::vector<Surface> read;
    return read_surfaces(in, blocks, read);
  };
  constexpr auto kHuge = std::numeric_limits<std::uint32_t>::max();
  EXPECT_TRUE(is_read({{0, 3, {5, 0, 0}}, {3, 2, {5, 0, 0}}}));
  EXPECT_FALSE(is_read({{0, 4, {5, 0, 0}}}));  // two rows of blocks
  EXPECT_FALSE(is_read({{3, 3, {5, 0, 0}}}));  // beyond the last block
  EXPECT_FALSE(is_read({{5, 1, {5, 0, 0}}}));
  EXPECT_FALSE(is_read({{kHuge, 1, {5, 0, 0}}}));
  EXPECT_FALSE(is_read({{0, kHuge, {5, 0, 0}}}));
  EXPECT_FALSE(is_read({{0, 1, {-5, 0, 0}}}));  // a range below zero
  EXPECT_FALSE(is_read({{0, 1, {2'000'001, 0, 0}}}));
  EXPECT_FALSE(is_read(std::vector<Surface>(6, {0, 1, {5, 0, 0}})));  // more than blocks
}

TEST(Surface, PaintingRefusesASurfaceWithoutARange) {
  const RangeImage image = image_of(4, 8, [](int, int) { return 10.0; });
  std::vector<Block> blocks;
  list_occupied_blocks(image, 4, blocks);
  constexpr auto kMost = std::numeric_limits<std::int32_t>::max();
  constexpr auto kLeast = std::numeric_limits<std::int32_t>::min();
  for (const SurfaceModel model : {SurfaceModel::surface, SurfaceModel::plane}) {
    for (const Coefficients c : {Coefficients{0, 0, 0}, Coefficients{133, -200, 0},
                                 Coefficients{133, kMost, kLeast}, Coefficients{2'000'000, 0, 0}}) {
      RangeImage painted = image;
      std::vector<std::uint8_t> fitted;
      EXPECT_FALSE(paint_surfaces(std::vector<Surface>{{0, 2, c}}, blocks, {4, 300, model}, painted,
                                  fitted));
    }
  }
}

}  // namespace
}  // namespace sweepcast::rcpcc
