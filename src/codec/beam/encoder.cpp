#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "codec/beam/alignment.hpp"
#include "codec/beam/codec.hpp"
#include "codec/beam/error_bound.hpp"
#include "codec/beam/model_bytes.hpp"
#include "rate/beam_quality.hpp"

namespace sweepcast::beam {
namespace {

// Base of the lattice: every 4th row, every 16th column.
constexpr int kBaseRows = 4;
constexpr int kBaseCols = 16;

// The bound under which coordinates are coded before what is missing to the exact ones: measured,
// it gives the fewest bytes in all, within 2 % on every sensor's sweeps.
constexpr double kLosslessError = 0.01;

std::uint64_t as_unsigned(std::int64_t value) {
  return static_cast<std::uint64_t>(value);
}

BeamQuality quality_of(const BeamOptions& options) {
  if (options.level) return kBeamLevels[static_cast<std::size_t>(*options.level)];
  BeamQuality quality;
  quality.step_m.fill(2.0 * (options.lossless ? kLosslessError : options.max_error_m));
  return quality;
}

std::uint32_t count_points(std::span<const std::int32_t> range) {
  return static_cast<std::uint32_t>(
      std::count_if(range.begin(), range.end(), [](std::int32_t r) { return r != 0; }));
}

}  // namespace

Status check(const BeamOptions& options) {
  if (!(options.max_error_m >= 0.001 && options.max_error_m <= 2.0)) {
    return fail(ErrorCode::invalid_argument, "the maximum error is " +
                                                 std::to_string(options.max_error_m) +
                                                 "; it must lie between 0.001 and 2 m");
  }
  if (!(options.intensity_step >= 0.0 && options.intensity_step <= 1e6)) {
    return fail(ErrorCode::invalid_argument, "the intensity step is " +
                                                 std::to_string(options.intensity_step) +
                                                 "; it must lie between 0 (exact) and 1e6");
  }
  if (options.level && (*options.level < 0 || *options.level >= int{kBeamLevels.size()})) {
    return fail(ErrorCode::invalid_argument,
                "the level is " + std::to_string(*options.level) + "; it must lie between 0 and 5");
  }
  if ((options.level ? 1 : 0) + (options.target_bytes > 0 ? 1 : 0) + (options.lossless ? 1 : 0) >
      1) {
    return fail(ErrorCode::invalid_argument,
                "only one of level, target_bytes and lossless can be had at a time");
  }
  if (options.model_interval < 1) {
    return fail(ErrorCode::invalid_argument, "the model interval must be at least 1 frame");
  }
  return {};
}

Encoder::Encoder(const BeamOptions& options, const Crop& crop)
    : options_(options), imager_(crop), quality_(quality_of(options)) {
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

// One sweep's way: sensor model, range image, layers of ranges; what has no cell goes aside.
Status Encoder::encode(const CloudView& cloud, const SweepInfo& info, PartList& parts,
                       SweepCounts& counts) {
  counts = {};
  counts.points_in = static_cast<std::uint32_t>(cloud.size);
  parts.clear();
  if (budget_) quality_ = beam_quality(budget_->begin());
  attributes_.read(cloud, options_);
  imager_.project(cloud, error_m(), counts);
  write_model_part(parts);
  if (!budget_) {
    write_sweep(cloud, parts, counts);
    return {};
  }
  return fit_budget(cloud, info, parts, counts);
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
  do {
    if (next) write_at(*next);
    tried = next;
    next = budget_->next(frame_size(CodecId::beam, info, counts, parts, kept));
  } while (next);
  if (!budget_->best()) {
    return fail(ErrorCode::limit, "the sweep does not fit " +
                                      std::to_string(options_.target_bytes) +
                                      " bytes even at its coarsest; allow more, or crop it");
  }
  if (tried && budget_->best() != tried) write_at(*budget_->best());
  return {};
}

// All that follows the sensor model.
void Encoder::write_sweep(const CloudView& cloud, PartList& parts, SweepCounts& counts) {
  BeamImage& image = imager_.image();
  const SensorModel* model = image.cols > 0 ? imager_.model() : nullptr;
  if (model != nullptr) plan_layers();
  write_grid(parts);
  write_extras(parts, counts);
  attributes_.begin(model, image, model != nullptr ? &plan_ : nullptr, range_, parts);
  attributes_.write_extras(extra_points_, parts);
  if (model != nullptr) write_layers(parts, counts);
  if (!options_.lossless && !options_.keep_order) return;
  std::vector<std::int32_t> ranges;
  if (model != nullptr) ranges = take_decoded();
  if (options_.lossless) write_exact_part(ranges, parts);
  if (options_.keep_order) {
    parts.begin(static_cast<std::uint8_t>(Part::order));
    write_order(original_order(cloud.size, cloud.width, image, extra_points_), image,
                extra_points_.size(), parts.bytes());
  }
  if (model != nullptr) give_back();
}

void Encoder::write_layers(PartList& parts, SweepCounts& counts) {
  layers_.begin(plan_);
  for (int layer = 0; layer < LayerCoder::layers(plan_); ++layer) {
    parts.begin(static_cast<std::uint8_t>(static_cast<int>(Part::layer) + layer));
    layers_.encode(layer, {range_, azimuth_, height_}, parts.bytes());
    attributes_.write_layer(layer, layers_, parts);
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

// Puts what the decoder has in the place of the image's ranges: cells that thinning left out have
// none. Gives the true ranges of those that it has, row by row.
std::vector<std::int32_t> Encoder::take_decoded() {
  BeamImage& image = imager_.image();
  std::vector<std::int32_t> decoded, truth;
  std::vector<CellState> state;
  layers_.read(decoded, state);
  for_each_aligned(*imager_.model(), image,
                   [&](int /*row*/, std::size_t cell, std::size_t aligned) {
                     const bool measured = state[aligned] == CellState::measured;
                     if (measured) truth.push_back(image.range[cell]);
                     image.range[cell] = measured ? decoded[aligned] : 0;
                   });
  return truth;
}

// Undoes it.
void Encoder::give_back() {
  BeamImage& image = imager_.image();
  for_each_aligned(*imager_.model(), image,
                   [&](int /*row*/, std::size_t cell, std::size_t aligned) {
                     image.range[cell] = range_[aligned];
                   });
}

// What the decoder lacks to the true coordinates. `ranges`: as `take_decoded` gives them.
void Encoder::write_exact_part(std::span<const std::int32_t> ranges, PartList& parts) {
  const BeamImage& image = imager_.image();
  PointCloud truth;
  const auto add_truth = [&](std::uint32_t point) {
    truth.x.push_back(imager_.x()[point]);
    truth.y.push_back(imager_.y()[point]);
    truth.z.push_back(imager_.z()[point]);
  };
  placed_.clear();
  if (image.cols > 0) {
    imager_.unprojector().unproject(image, placed_);
    for (std::size_t cell = 0; cell < image.cells(); ++cell) {
      if (image.range[cell] != 0) add_truth(image.point[cell]);
    }
  }
  const double step = static_cast<double>(extras_step(error_m())) / kRangeUnits;
  append_places(lattice_, step, placed_);
  for (const std::uint32_t point : extra_points_) add_truth(point);
  parts.begin(static_cast<std::uint8_t>(Part::exact));
  const PointOrigins origins = origins_of(imager_.model(), image, lattice_.size());
  write_exact(placed_, origins, truth, ranges, parts.bytes());
}

void Encoder::plan_layers() {
  const BeamImage& image = imager_.image();
  set_plan(*imager_.model(), image.cols, kBaseRows, kBaseCols, plan_);
  plan_.effort = options_.effort;
  plan_.quality.resize(static_cast<std::size_t>(LayerCoder::layers(plan_)));
  for (std::size_t i = 0; i < plan_.quality.size(); ++i) {
    const auto tolerance = static_cast<std::int32_t>(quality_.tolerance_m[i] * kRangeUnits);
    plan_.quality[i] = {range_step(quality_.step_m[i] / 2.0), tolerance > 0 ? tolerance : -1};
  }
  const bool residuals = !image.azimuth_residual.empty();
  range_.resize(image.cells());
  azimuth_.resize(residuals ? image.cells() : 0);
  height_.resize(residuals ? image.cells() : 0);
  for_each_aligned(*imager_.model(), image,
                   [&](int /*row*/, std::size_t cell, std::size_t aligned) {
                     range_[aligned] = image.range[cell];
                     if (!residuals) return;
                     azimuth_[aligned] = image.azimuth_residual[cell];
                     height_[aligned] = image.height_residual[cell];
                   });
}

void Encoder::write_model_part(PartList& parts) {
  const SensorModel* model = imager_.model();
  if (model == nullptr) return;
  if (sent_model_ == imager_.model_id() && ++frames_since_model_ < options_.model_interval) return;
  sent_model_ = imager_.model_id();
  frames_since_model_ = 0;
  ByteWriter out = parts.begin(static_cast<std::uint8_t>(Part::model));
  write_model(*model, out);
}

void Encoder::write_grid(PartList& parts) {
  const BeamImage& image = imager_.image();
  ByteWriter out = parts.begin(static_cast<std::uint8_t>(Part::grid));
  out.put_varint(as_unsigned(image.cols));
  if (image.cols > 0) {
    out.put(imager_.model_id());
    out.put(static_cast<std::uint8_t>(plan_.effort));
    out.put(static_cast<std::uint8_t>(kBaseRows));
    out.put(static_cast<std::uint8_t>(kBaseCols));
    for (const LayerQuality& quality : plan_.quality) {
      out.put_varint(as_unsigned(quality.step));
      out.put_signed(quality.tolerance);
    }
    const bool residuals = !image.azimuth_residual.empty();
    out.put_varint(residuals ? as_unsigned(image.azimuth_divisor) : 0U);
    out.put_varint(as_unsigned(image.height_step));
    out.put(static_cast<std::uint8_t>(image.motion ? 1 : 0));
    if (image.motion) write_motion(*image.motion, out);
  }
  if (image.cols == 0) return;
  parts.begin(static_cast<std::uint8_t>(Part::firings));
  write_firings(image.firing_tick, parts.bytes(), image.held);
}

// Puts the points without a cell on a lattice, and counts those that cannot be coded.
void Encoder::gather_extras(SweepCounts& counts) {
  lattice_.clear();
  extra_points_.clear();
  const double per_metre = double{kRangeUnits} / extras_step(error_m());
  for (const ExtraPoint& extra : imager_.image().extras) {
    const std::array<double, 3> xyz{imager_.x()[extra.point], imager_.y()[extra.point],
                                    imager_.z()[extra.point]};
    LatticePoint place{};
    bool inside = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double steps = std::floor(xyz[axis] * per_metre + 0.5);
      inside = inside && std::abs(steps) < kLatticeLimit;  // not so where it is NaN
      place[axis] = inside ? static_cast<std::int32_t>(steps) : 0;
    }
    if (!(std::isfinite(xyz[0]) && std::isfinite(xyz[1]) && std::isfinite(xyz[2]))) {
      ++counts.not_finite;
    } else if (xyz[0] == 0.0 && xyz[1] == 0.0 && xyz[2] == 0.0) {
      ++counts.zero_range;
    } else if (!inside) {
      ++counts.out_of_view;
    } else {
      lattice_.push_back(place);
      extra_points_.push_back(extra.point);
    }
  }
}

void Encoder::write_extras(PartList& parts, SweepCounts& counts) {
  gather_extras(counts);
  counts.points_coded += static_cast<std::uint32_t>(lattice_.size());
  if (lattice_.empty()) return;
  ByteWriter out = parts.begin(static_cast<std::uint8_t>(Part::extras));
  out.put_varint(lattice_.size());
  out.put_varint(as_unsigned(extras_step(error_m())));
  sort_for_octree(lattice_, extra_points_);
  write_octree(lattice_, parts.bytes());
}

}  // namespace sweepcast::beam
