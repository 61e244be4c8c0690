// Range images coded layer by layer: within half a step, and any first layers alone.
#include "codec/beam/range_layers.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <string>

#include "core/random.hpp"

namespace sweepcast::beam {
namespace {

using test::random_bits;
using test::uniform_int;

struct Image {
  int rows = 0, cols = 0;
  std::vector<std::int32_t> range, azimuth, height;
  std::vector<CellState> state;  ///< of decoded images

  [[nodiscard]] std::size_t cells() const { return range.size(); }
  [[nodiscard]] LayerValues values() const { return {range, azimuth, height}; }
};

Image empty_image(int rows, int cols) {
  Image image;
  image.rows = rows;
  image.cols = cols;
  image.range.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols));
  return image;
}

/// Any range in any cell, a share of cells without.
Image noise(std::mt19937& random, int rows, int cols, int percent_empty) {
  Image image = empty_image(rows, cols);
  for (std::int32_t& range : image.range) {
    range =
        uniform_int(random, 0, 99) < percent_empty ? 0 : uniform_int(random, kNearest, kFarthest);
  }
  return image;
}

/// Ground, a wall, boxes in front of it, a hole and an empty sky: slopes and edges.
Image scene(std::mt19937& random, int rows, int cols, int percent_empty) {
  Image image = empty_image(rows, cols);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      const double turn = 6.283185307 * col / cols;
      const double ground = row * 2 > rows ? 17'000.0 / (0.4 * row / rows) : 1e9;
      const double wall = 120'000 + 40'000 * std::sin(turn);
      const double box = col * 20 / cols % 5 == 1 && row * 4 > rows ? 55'000 : 1e9;
      const bool hole = row * 10 < rows || col * 30 / cols == 7;
      const bool lost = uniform_int(random, 0, 99) < percent_empty;
      image.range[static_cast<std::size_t>(row * cols + col)] =
          hole || lost ? 0
                       : static_cast<std::int32_t>(std::min({ground, wall, box})) +
                             uniform_int(random, -100, 100);
    }
  }
  return image;
}

/// As `BeamImage` has them: mostly zero, now and then far off.
void add_residuals(std::mt19937& random, Image& image) {
  for (auto* plane : {&image.azimuth, &image.height}) {
    for (std::size_t cell = 0; cell < image.cells(); ++cell) {
      const bool zero = image.range[cell] == 0 || random_bits(random) % 3 != 0;
      const int reach = random_bits(random) % 50 == 0 ? 2'000'000 : 30;
      plane->push_back(zero ? 0 : uniform_int(random, -reach, reach));
    }
  }
}

LayerPlan plan_of(const Image& image, std::int32_t step, int base_rows = 4, int base_cols = 16,
                  Effort effort = Effort::normal) {
  LayerPlan plan;
  plan.effort = effort;
  plan.rows = image.rows;
  plan.cols = image.cols;
  plan.lattice = make_lattice(base_rows, base_cols);
  plan.quality.assign(static_cast<std::size_t>(LayerCoder::layers(plan)), {step, -1});
  for (int row = 0; row < image.rows; ++row) {
    plan.elevation.push_back(500'000 - 90'000 * row + row % 3 * 20'000);
  }
  return plan;
}

using Layers = std::vector<std::vector<std::byte>>;

Layers encode(const LayerPlan& plan, const Image& image) {
  LayerCoder coder;
  coder.begin(plan);
  Layers layers(static_cast<std::size_t>(LayerCoder::layers(plan)));
  for (std::size_t i = 0; i < layers.size(); ++i) {
    coder.encode(static_cast<int>(i), image.values(), layers[i]);
  }
  return layers;
}

/// Decodes the first `count` layers; cells not yet known are empty.
Image decode(const LayerPlan& plan, const Layers& layers, std::size_t count, bool residuals) {
  Image image = empty_image(plan.rows, plan.cols);
  image.azimuth.resize(residuals ? image.cells() : 0);
  image.height.resize(residuals ? image.cells() : 0);
  LayerCoder coder;
  coder.begin(plan);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_TRUE(coder.decode(static_cast<int>(i), layers[i], {image.azimuth, image.height}));
  }
  coder.read(image.range, image.state);
  return image;
}

void expect_within_half_a_step(const Image& decoded, const Image& truth, std::int32_t step) {
  std::size_t wrong_state = 0;
  std::size_t too_far = 0;
  for (std::size_t cell = 0; cell < truth.cells(); ++cell) {
    wrong_state += (decoded.range[cell] != 0) == (truth.range[cell] != 0) ? 0U : 1U;
    too_far += 2 * std::abs(decoded.range[cell] - truth.range[cell]) <= step ? 0U : 1U;
  }
  EXPECT_EQ(wrong_state, 0U);
  EXPECT_EQ(too_far, 0U);
}

/// Whether `part` has the values of `whole` in the cells of every `stride`-th column and no others.
void expect_columns_of(const Image& part, const Image& whole, int stride) {
  for (std::size_t cell = 0; cell < whole.cells(); ++cell) {
    const bool known =
        cell % static_cast<std::size_t>(whole.cols) % static_cast<std::size_t>(stride) == 0;
    ASSERT_EQ(part.range[cell], known ? whole.range[cell] : 0) << "cell " << cell;
    if (whole.azimuth.empty()) continue;
    ASSERT_EQ(part.azimuth[cell], known ? whole.azimuth[cell] : 0) << "cell " << cell;
    ASSERT_EQ(part.height[cell], known ? whole.height[cell] : 0) << "cell " << cell;
  }
}

void expect_all_prefixes(const Image& image, const LayerPlan& plan) {
  const std::int32_t step = plan.quality.front().step;
  SCOPED_TRACE(std::to_string(image.rows) + " x " + std::to_string(image.cols) + ", step " +
               std::to_string(step));
  const bool residuals = !image.azimuth.empty();
  const Layers layers = encode(plan, image);
  const Image whole = decode(plan, layers, layers.size(), residuals);
  expect_within_half_a_step(whole, image, step);
  EXPECT_EQ(whole.azimuth, image.azimuth);
  EXPECT_EQ(whole.height, image.height);
  int stride = plan.lattice.front().col_stride;
  EXPECT_EQ(1 << (layers.size() - 1), stride);
  for (std::size_t count = 1; count <= layers.size(); ++count, stride /= 2) {
    expect_columns_of(decode(plan, layers, count, residuals), whole, stride);
  }
}

Effort any_effort(std::mt19937& random) {
  return static_cast<Effort>(uniform_int(random, 0, static_cast<int>(Effort::best)));
}

constexpr std::int32_t kSteps[] = {1, 2, 19, 197, 988, 7911, 39'548, 1 << 20};

TEST(RangeLayers, AnyImageOfAnySizeAndStep) {
  std::mt19937 random(1);
  for (const auto& [rows, cols] :
       {std::pair{1, 1}, {1, 40}, {40, 1}, {3, 17}, {5, 16}, {4, 15}, {33, 129}}) {
    for (const std::int32_t step : kSteps) {
      Image image = scene(random, rows, cols, uniform_int(random, 0, 30));
      if (random_bits(random) % 2 == 0) add_residuals(random, image);
      expect_all_prefixes(image, plan_of(image, step, 4, 16, any_effort(random)));
      image = noise(random, rows, cols, uniform_int(random, 0, 100));
      if (random_bits(random) % 2 == 0) add_residuals(random, image);
      expect_all_prefixes(image, plan_of(image, step, 4, 16, any_effort(random)));
    }
  }
}

TEST(RangeLayers, AnyBaseOfTheLattice) {
  std::mt19937 random(2);
  const Image image = scene(random, 19, 70, 10);
  for (const int rows : {1, 2, 4, 8, 16}) {
    for (const int cols : {1, 2, 4, 8, 16}) {
      expect_all_prefixes(image, plan_of(image, 300, rows, cols));
    }
  }
}

TEST(RangeLayers, AWholeSweep) {
  std::mt19937 random(3);
  Image image = scene(random, 64, 2165, 5);
  expect_all_prefixes(image, plan_of(image, 988));
  add_residuals(random, image);
  expect_all_prefixes(image, plan_of(image, 197));
}

TEST(RangeLayers, EachLayerHasAStepOfItsOwn) {
  std::mt19937 random(8);
  const Image image = scene(random, 20, 200, 10);
  LayerPlan plan = plan_of(image, 100);
  for (std::size_t i = 0; i < plan.quality.size(); ++i) {
    plan.quality[i].step = 100 << i;
  }
  const Layers layers = encode(plan, image);
  const Image decoded = decode(plan, layers, layers.size(), false);
  for (std::size_t cell = 0; cell < image.cells(); ++cell) {
    const auto col = static_cast<unsigned>(cell % static_cast<std::size_t>(image.cols));
    const int layer = 4 - std::min(4, std::countr_zero(col | 16U));
    ASSERT_LE(2 * std::abs(decoded.range[cell] - image.range[cell]), 100 << layer) << cell;
  }
}

TEST(RangeLayers, ThinnedCellsAreFilledWithinTheToleranceOrKept) {
  std::mt19937 random(9);
  for (const Effort effort : {Effort::fast, Effort::normal, Effort::best}) {
    const Image image = scene(random, 32, 500, 3);
    LayerPlan plan = plan_of(image, 100, 4, 16, effort);
    const Layers all = encode(plan, image);
    const std::int32_t tolerance = 400;
    for (std::size_t i = 3; i < plan.quality.size(); ++i) plan.quality[i].tolerance = tolerance;
    const Layers layers = encode(plan, image);
    EXPECT_LT(layers.back().size() * 2, all.back().size());
    const Image decoded = decode(plan, layers, layers.size(), false);
    std::size_t filled = 0;
    for (std::size_t cell = 0; cell < image.cells(); ++cell) {
      const std::int32_t miss = std::abs(decoded.range[cell] - image.range[cell]);
      if (decoded.state[cell] == CellState::measured) {
        ASSERT_LE(2 * miss, 100) << cell;
      } else if (decoded.state[cell] == CellState::filled) {
        ++filled;
        ASSERT_TRUE(image.range[cell] == 0 || miss <= tolerance) << cell;
      } else if (decoded.state[cell] != CellState::assumed) {
        ASSERT_EQ(decoded.range[cell], 0) << cell;
      }
    }
    EXPECT_GT(filled, image.cells() / 4);
  }
}

TEST(RangeLayers, EachEffortTakesFewerBytesAndTheFormerBestStillDecodes) {
  std::mt19937 random(11);
  const Image image = scene(random, 32, 900, 5);
  const auto size_of = [&](const LayerPlan& plan) {
    const Layers layers = encode(plan, image);
    const Image decoded = decode(plan, layers, layers.size(), false);
    std::size_t size = 0;
    for (const auto& layer : layers) size += layer.size();
    for (std::size_t cell = 0; cell < image.cells(); ++cell) {
      EXPECT_LE(2 * std::abs(decoded.range[cell] - image.range[cell]), 100) << cell;
    }
    return size;
  };
  LayerPlan former = plan_of(image, 100, 4, 16, Effort::best);
  former.former_best = true;
  const std::size_t normal = size_of(plan_of(image, 100, 4, 16, Effort::normal));
  const std::size_t best = size_of(plan_of(image, 100, 4, 16, Effort::best));
  EXPECT_LT(best, size_of(former));
  EXPECT_LT(100 * best, 98 * normal);
}

TEST(RangeLayers, TheByteOfACodingTellsItsPlan) {
  for (std::uint8_t coding = 0; coding < 4; ++coding) {
    LayerPlan plan;
    EXPECT_TRUE(set_coding(coding, plan));
    EXPECT_EQ(coding_of(plan), coding);
    EXPECT_EQ(plan.effort, static_cast<Effort>(std::min<int>(coding, 2)));
  }
  LayerPlan plan;
  EXPECT_FALSE(set_coding(4, plan));
  EXPECT_FALSE(set_coding(255, plan));
}

TEST(RangeLayers, EmptyAndFullImages) {
  std::mt19937 random(4);
  for (const int percent_empty : {0, 100}) {
    const Image image = noise(random, 16, 400, percent_empty);
    expect_all_prefixes(image, plan_of(image, 988));
    if (percent_empty < 100) continue;
    std::size_t size = 0;
    for (const auto& layer : encode(plan_of(image, 988), image)) size += layer.size();
    EXPECT_LT(size, 40U);
  }
}

TEST(RangeLayers, NearestAndFarthestRanges) {
  Image image = empty_image(8, 40);
  for (std::size_t cell = 0; cell < image.cells(); ++cell) {
    image.range[cell] = cell % 3 == 0 ? kFarthest : cell % 3 == 1 ? kNearest : 0;
  }
  for (const std::int32_t step : kSteps) expect_all_prefixes(image, plan_of(image, step));
}

TEST(RangeLayers, SmoothSurfacesCostLittle) {
  std::mt19937 random(5);
  const Image smooth = scene(random, 64, 2165, 0);
  std::size_t size = 0;
  for (const auto& layer : encode(plan_of(smooth, 988), smooth)) size += layer.size();
  EXPECT_LT(static_cast<double>(size) * 8, 0.5 * static_cast<double>(smooth.cells()));
}

TEST(RangeLayers, ACoderCanBeUsedAgain) {
  std::mt19937 random(6);
  const Image first = scene(random, 9, 100, 5);
  const Image second = noise(random, 5, 33, 40);
  LayerCoder coder;
  for (const Image* image : {&first, &second, &first}) {
    const LayerPlan plan = plan_of(*image, 500);
    const Layers fresh = encode(plan, *image);
    coder.begin(plan);
    for (std::size_t i = 0; i < fresh.size(); ++i) {
      std::vector<std::byte> layer;
      coder.encode(static_cast<int>(i), image->values(), layer);
      EXPECT_EQ(layer, fresh[i]);
    }
  }
}

TEST(RangeLayers, DamagedLayersGiveRangesThatCanBe) {
  std::mt19937 random(7);
  Image image = scene(random, 16, 200, 10);
  add_residuals(random, image);
  const LayerPlan plan = plan_of(image, 988);
  const Layers sound = encode(plan, image);
  int refused = 0;
  for (int i = 0; i < 200; ++i) {
    LayerCoder coder;
    coder.begin(plan);
    for (std::size_t layer = 0; layer < sound.size(); ++layer) {
      std::vector<std::byte> bytes = sound[layer];
      if (i % 2 == 0) bytes.resize(bytes.size() / 3);
      for (int n = uniform_int(random, 0, 3); n > 0; --n) {
        bytes[random_bits(random) % bytes.size()] = static_cast<std::byte>(random_bits(random));
      }
      if (coder.decode(static_cast<int>(layer), bytes, {image.azimuth, image.height})) continue;
      ++refused;
      break;
    }
    coder.read(image.range, image.state);
    for (std::size_t cell = 0; cell < image.cells(); ++cell) {
      const std::int32_t range = image.range[cell];
      EXPECT_TRUE(range == 0 || image.state[cell] == CellState::measured) << cell;
      EXPECT_TRUE(range == 0 || (range >= kNearest && range <= kFarthest)) << cell;
    }
  }
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace sweepcast::beam
