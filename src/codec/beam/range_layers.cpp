#include "codec/beam/range_layers.hpp"

#include <algorithm>

#include "codec/beam/cell_coder.hpp"
#include "codec/entropy/range_coder.hpp"

namespace sweepcast::beam {
namespace {

constexpr int kTableBits = 13;
constexpr int kGroup = 8;  // cells whose states are said at once when they are as expected

// The weight of the upper of two rows for a row between: a plane's inverse range is about linear in
// the tangent of elevation.
std::uint32_t row_weight(const std::vector<std::int32_t>& elevation, int row, int stride) {
  constexpr std::uint32_t kEven = 32'768;
  if (row + stride >= static_cast<int>(elevation.size())) return kEven;
  const auto at = [&](int r) { return std::int64_t{elevation[static_cast<std::size_t>(r)]}; };
  const std::int64_t whole = at(row - stride) - at(row + stride);
  const std::int64_t part = at(row) - at(row + stride);
  if (part <= 0 || part >= whole) return kEven;
  return static_cast<std::uint32_t>(part * 65'536 / whole);
}

// Whether damaged bytes have ended, so that a few of them cannot keep the decoder busy for long.
bool ran_dry(const RangeDecoder& coder) {
  return coder.overran();
}
bool ran_dry(const RangeEncoder& /*coder*/) {
  return false;
}

// Codes the cells that a step adds, row by row: first which hold a point, then their ranges.
// `range` is null when decoding.
template <class Coder>
void code_step(Coder& coder, CellCoder& cells, PaddedImage& image, const LayerPlan& plan,
               std::uint32_t number, const std::int32_t* range) {
  const LatticeStep& step = plan.lattice[number];
  Traversal at(step, number, image.pitch());
  for (int row = at.first_row; row < plan.rows; row += at.row_stride) {
    if (step.kind == LatticeStep::Kind::rows) {
      at.neighbours.weight = row_weight(plan.elevation, row, step.row_stride);
    }
    const std::int32_t* truth =
        range == nullptr ? nullptr : range + static_cast<std::ptrdiff_t>(row) * plan.cols;
    std::uint32_t history = 0;
    for (int col = at.first_col; col < plan.cols; col += at.col_stride * kGroup) {
      if (ran_dry(coder)) return;
      const int count = std::min(kGroup, (plan.cols - col + at.col_stride - 1) / at.col_stride);
      if (cells.code_group(coder, image.at(row, col), at.col_stride, count, at.neighbours,
                           truth == nullptr ? nullptr : truth + col, history)) {
        continue;
      }
      for (int i = 0; i < count; ++i) {
        const int c = col + i * at.col_stride;
        cells.code_state(coder, image.at(row, c), at.neighbours, truth != nullptr && truth[c] != 0,
                         static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(c));
      }
    }
    for (int col = at.first_col; col < plan.cols; col += at.col_stride) {
      PaddedImage::Cell* cell = image.at(row, col);
      if (cell->state != 2) continue;
      if (ran_dry(coder)) return;
      cells.code_range(coder, cell, at.neighbours, truth == nullptr ? 0 : truth[col]);
    }
  }
}

// Angular residuals: mostly zero, and where not, much like the one before.
class ResidualCoder {
 public:
  void begin() {
    mixer_.reset();
    last_ = 0;
  }

  template <class Coder>
  std::int32_t code(Coder& coder, std::int32_t value) {
    const auto size = static_cast<std::uint32_t>(std::abs(value));
    const std::uint32_t near = std::min(last_, 31U);
    std::uint32_t coded = 0;
    while (coded < kUnary &&
           mixer_.code(coder, {hash_context(coded, near), hash_context(coded, 100U)}, 0,
                       size > coded)) {
      ++coded;
    }
    if (coded == kUnary) {
      std::uint32_t rest = 0;
      for (int bit = kPlainBits; bit-- > 0;) {
        rest = rest * 2 + (coder.code((((size - kUnary) >> bit) & 1U) != 0, kEven) ? 1U : 0U);
      }
      coded += rest;
    }
    last_ = (last_ + coded + 1) / 2;
    if (coded == 0) return 0;
    const bool negative = mixer_.code(
        coder, {hash_context(200U, last_negative_), hash_context(201U, near)}, 1, value < 0);
    last_negative_ = negative ? 1U : 0U;
    return negative ? -static_cast<std::int32_t>(coded) : static_cast<std::int32_t>(coded);
  }

 private:
  static constexpr std::uint32_t kUnary = 20;
  static constexpr std::uint32_t kEven = 32'768;
  static constexpr int kPlainBits = 24;
  BitMixer<2> mixer_{12, 2};
  std::uint32_t last_ = 0;
  std::uint32_t last_negative_ = 0;
};

}  // namespace

struct LayerCoder::Models {
  CellCoder cells{kTableBits};
  ResidualCoder azimuth, height;
};

LayerCoder::LayerCoder() : models_(std::make_unique<Models>()) {}
LayerCoder::LayerCoder(LayerCoder&&) noexcept = default;
LayerCoder& LayerCoder::operator=(LayerCoder&&) noexcept = default;
LayerCoder::~LayerCoder() = default;

void LayerCoder::begin(const LayerPlan& plan) {
  plan_ = plan;
  image_.reset(plan.rows, plan.cols, plan.lattice.front().row_stride,
               plan.lattice.front().col_stride);
  models_->cells.begin(plan.step);
  models_->azimuth.begin();
  models_->height.begin();
}

int LayerCoder::layers(const LayerPlan& plan) {
  const std::uint32_t base = steps_of(plan.lattice, 0).second;
  return 1 + static_cast<int>(plan.lattice.size() - base);
}

// Calls visit(index of the cell) for the cells of a step that hold a point.
template <class Visit>
void LayerCoder::for_each_point(std::uint32_t number, Visit visit) {
  const Traversal at(plan_.lattice[number], number, image_.pitch());
  for (int row = at.first_row; row < plan_.rows; row += at.row_stride) {
    for (int col = at.first_col; col < plan_.cols; col += at.col_stride) {
      if (image_.at(row, col)->state != 2) continue;
      visit(static_cast<std::size_t>(row) * static_cast<std::size_t>(plan_.cols) +
            static_cast<std::size_t>(col));
    }
  }
}

void LayerCoder::encode(int layer, const LayerValues& values, std::vector<std::byte>& out) {
  RangeEncoder coder(out);
  const auto [first, last] = steps_of(plan_.lattice, layer);
  for (std::uint32_t step = first; step < last; ++step) {
    code_step(coder, models_->cells, image_, plan_, step, values.range.data());
    if (values.azimuth.empty()) continue;
    for_each_point(step, [&](std::size_t cell) {
      models_->azimuth.code(coder, values.azimuth[cell]);
      models_->height.code(coder, values.height[cell]);
    });
  }
  coder.finish();
}

bool LayerCoder::decode(int layer, std::span<const std::byte> bytes,
                        const LayerResiduals& residuals) {
  RangeDecoder coder(bytes);
  const auto [first, last] = steps_of(plan_.lattice, layer);
  for (std::uint32_t step = first; step < last; ++step) {
    code_step(coder, models_->cells, image_, plan_, step, nullptr);
    if (coder.overran()) return false;
    if (residuals.azimuth.empty()) continue;
    for_each_point(step, [&](std::size_t cell) {
      residuals.azimuth[cell] = models_->azimuth.code(coder, 0);
      residuals.height[cell] = models_->height.code(coder, 0);
    });
  }
  return !coder.overran();
}

}  // namespace sweepcast::beam
