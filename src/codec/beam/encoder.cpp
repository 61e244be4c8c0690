#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "codec/beam/alignment.hpp"
#include "codec/beam/codec.hpp"
#include "codec/beam/crowding.hpp"
#include "codec/beam/error_bound.hpp"
#include "codec/beam/missed_points.hpp"
#include "codec/beam/model_bytes.hpp"
#include "core/trig.hpp"
#include "rate/beam_quality.hpp"

namespace sweepcast::beam {
namespace {

// Base of the lattice: every 4th row, every 16th column.
constexpr int kBaseRows = 4;
constexpr int kBaseCols = 16;

// The bound under which coordinates are coded before what is missing to the exact ones: measured,
// it gives the fewest bytes in all, within 2 % on every sensor's sweeps.
constexpr double kLosslessError = 0.01;

// Of level 0. With a budget the quality is found after the projection, which begins with that of
// the sweep before: were it finer than this, residuals of the angles would take the bytes of
// points.
constexpr double kFinestBudgetError = kBeamLevels.front().step_m[0] / 2.0;

// How often it is estimated which points of a crowded sweep had better be extras.
constexpr int kMostTries = 3;
// After how many frames that is done again.
constexpr int kReviewInterval = 10;

// Points that thinning would let vanish are kept where nothing is within so many of its last steps:
// measured, on KITTI's sweeps, nearer ones are not worth their bytes.
constexpr std::int32_t kMissedSteps = 8;

// Under wider bounds an octree's points would be off by as much as the bound, where the image's are
// off by half of it: too dear for the bytes.
constexpr double kWidestCrowd = 0.1;

// For messages, without idle zeros. Emscripten's library has no to_chars of numbers like these.
std::string in_digits(double number) {
  std::array<char, 32> text{};
  (void)std::snprintf(text.data(), text.size(), "%.9g", number);
  return text.data();
}

BeamQuality quality_of(const BeamOptions& options) {
  if (options.level) return kBeamLevels[static_cast<std::size_t>(*options.level)];
  BeamQuality quality;
  quality.step_m.fill(2.0 * (options.lossless ? kLosslessError : options.max_error_m));
  return quality;
}

bool is_layer(std::uint8_t kind) {
  return kind >= static_cast<std::uint8_t>(Part::layer) &&
         kind < static_cast<std::uint8_t>(Part::layer_attributes);
}

std::size_t range_bytes(const PartList& parts) {
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (is_layer(parts.kind(i))) bytes += parts.part(i).size();
  }
  return bytes;
}

std::uint32_t count_points(std::span<const std::int32_t> range) {
  return static_cast<std::uint32_t>(
      std::count_if(range.begin(), range.end(), [](std::int32_t r) { return r != 0; }));
}

}  // namespace

Status check(const BeamOptions& options) {
  if (!(options.max_error_m >= 0.001 && options.max_error_m <= 2.0)) {
    return fail(ErrorCode::invalid_argument, "the maximum error is " +
                                                 in_digits(options.max_error_m) +
                                                 "; it must lie between 0.001 and 2 m");
  }
  if (!(options.intensity_step >= 0.0 && options.intensity_step <= 1e6)) {
    return fail(ErrorCode::invalid_argument, "the intensity step is " +
                                                 in_digits(options.intensity_step) +
                                                 "; it must lie between 0 (exact) and 1e6");
  }
  if (options.level && (*options.level < 0 || *options.level >= int{kBeamLevels.size()})) {
    return fail(ErrorCode::invalid_argument,
                "the level is " + std::to_string(*options.level) + "; it must lie between 0 and 5");
  }
  if ((options.level ? 1 : 0) + (options.target_bytes > 0 ? 1 : 0) + (options.lossless ? 1 : 0) >
      1) {
    return fail(
        ErrorCode::invalid_argument,
        "only one of a level, a target of bytes and lossless can be had at a time; choose one");
  }
  if (options.model_interval < 1) {
    return fail(ErrorCode::invalid_argument, "the model interval must be at least 1 frame");
  }
  return {};
}

Encoder::Encoder(const BeamOptions& options, const Crop& crop, StageClock* stages)
    : options_(options), imager_(crop), quality_(quality_of(options)), stages_(stages) {
  if (options_.target_bytes > 0) budget_.emplace(options_.target_bytes);
}

Status Encoder::set_target_bytes(std::size_t bytes) {
  if (!budget_ || bytes == 0) {
    return fail(ErrorCode::invalid_argument,
                "the encoder was not made for a target, or the target is 0 bytes; set "
                "BeamOptions::target_bytes above 0 when making it");
  }
  options_.target_bytes = bytes;
  budget_->set_bytes(bytes);
  return {};
}

double Encoder::projection_error_m() const {
  return budget_ ? std::max(error_m(), kFinestBudgetError) : error_m();
}

// One sweep's way: sensor model, range image, layers of ranges; what has no cell goes aside.
Status Encoder::encode(const CloudView& cloud, const SweepInfo& info, PartList& parts,
                       SweepCounts& counts) {
  counts = {};
  counts.points_in = static_cast<std::uint32_t>(cloud.size);
  parts.clear();
  if (budget_) quality_ = beam_quality(budget_->begin());
  lap_ = StageLap(stages_);
  attributes_.read(cloud, options_);
  lap_.end("attributes");
  imager_.project(cloud, projection_error_m(), counts);
  lap_.end("sensor model, range image");
  const bool may_choose = !budget_ && !options_.level && !options_.lossless &&
                          options_.max_error_m <= kWidestCrowd && options_.effort != Effort::fast &&
                          imager_.image().cols > 0;
  const bool review = may_choose && frames_to_review_-- == 0;
  if (may_choose && !review) {
    if (extras_.all) {
      imager_.move_all();
    } else {
      imager_.move_nearer(extras_.nearer);
    }
  }
  write_model_part(parts);
  if (budget_) return fit_budget(cloud, info, parts, counts);
  if (review) {
    write_smallest(cloud, info, parts, counts);
  } else {
    write_sweep(cloud, parts, counts);
  }
  return {};
}

// Where points crowd, tries which of them had better be extras, keeps the smallest frame, and does
// likewise in the frames that follow.
void Encoder::write_smallest(const CloudView& cloud, const SweepInfo& info, PartList& parts,
                             SweepCounts& counts) {
  const SweepCounts projected = counts;
  const std::size_t kept = parts.size();
  const double step = static_cast<double>(extras_step(error_m())) / kRangeUnits;
  write_sweep(cloud, parts, counts);
  frames_to_review_ = kReviewInterval - 1;
  extras_ = {};
  PartList smallest;
  SweepCounts its_counts;
  std::size_t least = 0;
  const auto keep_smaller = [&](const ExtrasChoice& choice) {
    const std::size_t size = frame_size(CodecId::beam, info, counts, parts, 0);
    if (least != 0 && size >= least) return false;
    least = size;
    smallest = parts;
    its_counts = counts;
    extras_ = choice;
    return true;
  };
  const auto try_again = [&](std::size_t first, const ExtrasChoice& choice) {
    parts.truncate(first);
    counts = projected;
    write_sweep(cloud, parts, counts);
    return keep_smaller(choice);
  };
  bool saves = true;
  for (int tries = 0; tries < kMostTries && saves; ++tries) {
    const std::int32_t range = crowded_range(imager_.image(), imager_.x(), imager_.y(), imager_.z(),
                                             step, range_bytes(parts));
    if (range == 0) break;
    if (tries == 0) keep_smaller({});
    saves = false;
    for (const std::int32_t within : {range / 4 * 3, range, range / 3 * 4}) {  // it is rough
      const bool saved = saves;
      imager_.move_nearer(within);
      saves = try_again(kept, {within, false});
      if (saved && !saves) break;
    }
  }
  if (least == 0) return;  // no crowd
  if (extras_.nearer > 0) {
    imager_.move_all();
    try_again(0, {0, true});
  }
  parts = std::move(smallest);
  counts = its_counts;
  // A model that this frame was to bring comes with the next that has an image.
  if (kept > 0 && parts.kind(0) != static_cast<std::uint8_t>(Part::model)) sent_model_.reset();
}

// Tries qualities until the frame, its sensor model apart, fits.
Status Encoder::fit_budget(const CloudView& cloud, const SweepInfo& info, PartList& parts,
                           SweepCounts& counts) {
  const std::size_t kept = parts.size();
  const SweepCounts projected = counts;
  const auto write_at = [&](double level) {
    quality_ = beam_quality(level);
    parts.truncate(kept);
    counts = projected;
    write_sweep(cloud, parts, counts);
  };
  write_sweep(cloud, parts, counts);
  std::optional<double> tried, next;
  std::size_t size = 0;
  do {
    if (next) write_at(*next);
    tried = next;
    size = frame_size(CodecId::beam, info, counts, parts, kept);
    next = budget_->next(size);
  } while (next);
  if (!budget_->best()) {
    return fail(ErrorCode::limit, "the sweep does not fit " +
                                      std::to_string(options_.target_bytes) +
                                      " bytes: at its coarsest it takes " + std::to_string(size) +
                                      "; set a target of at least that many, or crop it");
  }
  if (tried && budget_->best() != tried) write_at(*budget_->best());
  return {};
}

// All that follows the sensor model.
void Encoder::write_sweep(const CloudView& cloud, PartList& parts, SweepCounts& counts) {
  BeamImage& image = imager_.image();
  const SensorModel* model = image.cols > 0 ? imager_.model() : nullptr;
  if (model != nullptr) {
    plan_layers();
    lap_.end("sensor model, range image");
    move_missed();
    lap_.end("points that thinning misses");
  }
  write_grid(parts);
  lap_.end("firings");
  write_extras(parts, counts);
  lap_.end("points without a cell");
  attributes_.begin(image, model != nullptr ? &plan_ : nullptr, first_column_, range_, parts);
  attributes_.write_extras(extra_points_, parts);
  lap_.end("attributes");
  if (model != nullptr) write_layers(parts, counts);
  if (options_.lossless || options_.keep_order) write_original(cloud, parts);
  restore_missed();
  lap_.end("exact coordinates, order");
}

// Moves to the extras what thinning would let vanish: found by coding the layers once.
void Encoder::move_missed() {
  missed_.clear();
  const std::int32_t reach = kMissedSteps * plan_.quality.back().step;
  const bool may_miss =
      std::any_of(plan_.quality.begin(), plan_.quality.end(),
                  [reach](const LayerQuality& quality) { return quality.tolerance > reach; });
  if (!may_miss) return;
  layers_.begin(plan_);
  std::vector<std::byte> bytes;
  for (int layer = 0; layer < LayerCoder::layers(plan_); ++layer) {
    layers_.encode(layer, {range_, azimuth_, height_}, bytes);
  }
  std::vector<std::int32_t> decoded;
  std::vector<CellState> state;
  layers_.read(decoded, state);
  BeamImage& image = imager_.image();
  const auto cols = static_cast<std::size_t>(image.cols);
  const double turns = static_cast<double>(image.firing_tick.back() - image.firing_tick.front()) /
                       imager_.model()->ticks_per_turn;
  const double column_angle = 2.0 * kPi * turns / static_cast<double>(cols);
  std::vector<bool> is_missed(range_.size());
  const ThinnedImage thinned{cols, column_angle, plan_.elevation, range_, decoded, state};
  for (const std::size_t cell : missed_cells(thinned, reach)) {
    is_missed[cell] = true;
    range_[cell] = 0;
  }
  for_each_aligned(first_column_, image, [&](std::size_t cell, std::size_t aligned) {
    if (!is_missed[aligned]) return;
    missed_.emplace_back(cell, image.range[cell]);
    image.range[cell] = 0;
    image.extras.push_back({image.point[cell], ExtraReason::misfit});
  });
}

// Undoes it.
void Encoder::restore_missed() {
  BeamImage& image = imager_.image();
  for (const auto& [cell, range] : missed_) image.range[cell] = range;
  image.extras.resize(image.extras.size() - missed_.size());
  missed_.clear();
}

void Encoder::write_layers(PartList& parts, SweepCounts& counts) {
  layers_.begin(plan_);
  for (int layer = 0; layer < LayerCoder::layers(plan_); ++layer) {
    parts.begin(static_cast<std::uint8_t>(static_cast<int>(Part::layer) + layer));
    layers_.encode(layer, {range_, azimuth_, height_}, parts.bytes());
    lap_.end("ranges");
    attributes_.write_layer(layer, layers_, parts);
    lap_.end("attributes");
  }
  const std::uint32_t points = count_points(range_);
  std::uint32_t measured = points;
  if (std::any_of(plan_.quality.begin(), plan_.quality.end(),
                  [](const LayerQuality& quality) { return quality.tolerance >= 0; })) {
    measured = static_cast<std::uint32_t>(layers_.measured());
  }
  counts.points_coded += measured;
  counts.thinned += points - measured;
}

void Encoder::plan_layers() {
  const BeamImage& image = imager_.image();
  set_plan(*imager_.model(), image.cols, kBaseRows, kBaseCols, plan_);
  plan_.effort = options_.effort;
  find_first_columns(*imager_.model(), image, first_column_);
  plan_.quality.resize(static_cast<std::size_t>(LayerCoder::layers(plan_)));
  for (std::size_t i = 0; i < plan_.quality.size(); ++i) {
    const auto tolerance = static_cast<std::int32_t>(quality_.tolerance_m[i] * kRangeUnits);
    plan_.quality[i] = {range_step(quality_.step_m[i] / 2.0), tolerance > 0 ? tolerance : -1};
  }
  const bool residuals = !image.azimuth_residual.empty();
  range_.resize(image.cells());
  azimuth_.resize(residuals ? image.cells() : 0);
  height_.resize(residuals ? image.cells() : 0);
  for_each_aligned(first_column_, image, [&](std::size_t cell, std::size_t aligned) {
    range_[aligned] = image.range[cell];
    if (!residuals) return;
    azimuth_[aligned] = image.azimuth_residual[cell];
    height_[aligned] = image.height_residual[cell];
  });
}

}  // namespace sweepcast::beam
