#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "codec/beam/alignment.hpp"
#include "codec/beam/codec.hpp"
#include "codec/beam/model_bytes.hpp"
#include "core/crc32.hpp"
#include "sensor/beam_geometry.hpp"
#include "sensor/crop.hpp"
#include "sensor/motion.hpp"

namespace sweepcast::beam {
namespace {

// Base of the lattice: every 4th row, every 16th column.
constexpr int kBaseRows = 4;
constexpr int kBaseCols = 16;

// Share of the error bound that angles may take, the rest being the ranges'. Errors across and
// along a beam are at right angles, so that a tenth of the bound costs the ranges half a per cent
// of it.
constexpr double kAngularShare = 0.15;

// The bound under which coordinates are coded before what is missing to the exact ones: measured,
// it gives the fewest bytes in all, within 2 % on every sensor's sweeps.
constexpr double kLosslessError = 0.01;

// Points on the extras' lattice are at most this far from it, in steps: half a cube's diagonal.
constexpr double kHalfDiagonal = 0.8660254037844387;

std::uint64_t as_unsigned(std::int64_t value) {
  return static_cast<std::uint64_t>(value);
}

// Half the step of ranges, metres: what angles leave, less the rounding of ranges to 0.1 mm and of
// coordinates to float32.
double range_error(const BeamOptions& options) {
  constexpr double kRounding = 0.6e-4;
  return options.max_error_m * std::sqrt(1.0 - kAngularShare * kAngularShare) - kRounding;
}

std::int32_t range_step(const BeamOptions& options) {
  return std::max(1, static_cast<std::int32_t>(2.0 * range_error(options) * kRangeUnits));
}

// The step of the extras' lattice, 0.1 mm.
std::int32_t extras_step(const BeamOptions& options) {
  return std::max(1, static_cast<std::int32_t>(options.max_error_m / kHalfDiagonal * kRangeUnits));
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
  if (options.model_interval < 1) {
    return fail(ErrorCode::invalid_argument, "the model interval must be at least 1 frame");
  }
  return {};
}

Encoder::Encoder(const BeamOptions& options, const Crop& crop) : options_(options), crop_(crop) {
  if (options_.lossless) options_.max_error_m = kLosslessError;
}

// One sweep's way: sensor model, range image, layers of ranges; what has no cell goes aside.
void Encoder::encode(const CloudView& cloud, PartList& parts, SweepCounts& counts) {
  counts = {};
  counts.points_in = static_cast<std::uint32_t>(cloud.size);
  parts.clear();
  if (!model_ && sweeps_to_wait_-- == 0) learn_model(cloud);
  attributes_.read(cloud, options_);
  project(cloud, counts);
  write_model_part(parts);
  if (image_.cols > 0) plan_layers();
  write_grid(parts);
  write_extras(parts, counts);
  const bool has_image = image_.cols > 0;
  attributes_.begin(has_image ? &*model_ : nullptr, image_, has_image ? &plan_ : nullptr, range_,
                    parts);
  attributes_.write_extras(extra_points_, parts);
  if (has_image) write_layers(parts, counts);
  if (!options_.lossless && !options_.keep_order) return;
  std::vector<std::int32_t> ranges;
  if (has_image) ranges = take_decoded();
  if (options_.lossless) write_exact_part(ranges, parts);
  if (!options_.keep_order) return;
  parts.begin(static_cast<std::uint8_t>(Part::order));
  write_order(original_order(cloud.size, cloud.width, image_, extra_points_), image_,
              extra_points_.size(), parts.bytes());
}

void Encoder::write_layers(PartList& parts, SweepCounts& counts) {
  layers_.begin(plan_);
  for (int layer = 0; layer < LayerCoder::layers(plan_); ++layer) {
    parts.begin(static_cast<std::uint8_t>(static_cast<int>(Part::layer) + layer));
    layers_.encode(layer, {range_, azimuth_, height_}, parts.bytes());
    attributes_.write_layer(layer, layers_, parts);
  }
  counts.points_coded += static_cast<std::uint32_t>(
      range_.size() - as_unsigned(std::count(range_.begin(), range_.end(), 0)));
}

// Puts what the decoder has in the place of the image's ranges: cells that thinning left out have
// none. Gives the true ranges of those that it has, row by row.
std::vector<std::int32_t> Encoder::take_decoded() {
  std::vector<std::int32_t> decoded, truth;
  std::vector<CellState> state;
  layers_.read(decoded, state);
  for_each_aligned(*model_, image_, [&](int /*row*/, std::size_t cell, std::size_t aligned) {
    const bool measured = state[aligned] == CellState::measured;
    if (measured) truth.push_back(image_.range[cell]);
    image_.range[cell] = measured ? decoded[aligned] : 0;
  });
  return truth;
}

// What the decoder lacks to the true coordinates. `ranges`: as `take_decoded` gives them.
void Encoder::write_exact_part(std::span<const std::int32_t> ranges, PartList& parts) {
  PointCloud truth;
  const auto add_truth = [&](std::uint32_t point) {
    truth.x.push_back(x_[point]);
    truth.y.push_back(y_[point]);
    truth.z.push_back(z_[point]);
  };
  placed_.clear();
  if (image_.cols > 0) {
    unprojector_->unproject(image_, placed_);
    for (std::size_t cell = 0; cell < image_.cells(); ++cell) {
      if (image_.range[cell] != 0) add_truth(image_.point[cell]);
    }
  }
  const double step = static_cast<double>(extras_step(options_)) / kRangeUnits;
  for (std::size_t i = 0; i < lattice_.size(); ++i) {
    placed_.x.push_back(static_cast<float>(lattice_[i][0] * step));
    placed_.y.push_back(static_cast<float>(lattice_[i][1] * step));
    placed_.z.push_back(static_cast<float>(lattice_[i][2] * step));
    add_truth(extra_points_[i]);
  }
  parts.begin(static_cast<std::uint8_t>(Part::exact));
  const PointOrigins origins = origins_of(model_ ? &*model_ : nullptr, image_, lattice_.size());
  write_exact(placed_, origins, truth, ranges, parts.bytes());
}

void Encoder::learn_model(const CloudView& cloud) {
  const auto estimate = estimate_sensor_model(std::span(&cloud, 1));
  if (!estimate) {
    // Looking takes seconds: do it less and less often for a sensor that seems to have no beams.
    patience_ = std::min(2 * patience_, 1024);
    sweeps_to_wait_ = patience_;
    return;
  }
  model_ = estimate->model;
  if (!estimate->motions.empty()) motion_ = estimate->motions.front();
  projector_.emplace(*model_);
  unprojector_.emplace(*model_);
  frames_since_model_ = options_.model_interval;
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  write_model(*model_, out);
  model_id_ = crc32(bytes);
}

void Encoder::project(const CloudView& cloud, SweepCounts& counts) {
  x_.resize(cloud.size);
  y_.resize(cloud.size);
  z_.resize(cloud.size);
  cloud.x.read(0, x_);
  cloud.y.read(0, y_);
  cloud.z.read(0, z_);
  choose(counts);
  if (!model_) return list_as_extras();
  BeamGridOptions grid;
  grid.max_error_m = kAngularShare * options_.max_error_m;
  grid.nearest = kNearest;
  grid.farthest = kFarthest;
  const CloudView floats = CloudView::columns(x_, y_, z_);
  if (motion_) {  // the sensor's sweeps come deskewed: each by a motion of its own
    motion_ = estimate_motion(floats, *model_, &*motion_);
    grid.motion = motion_;
  }
  if (counts.cropped == 0) {
    projector_->project(x_, y_, z_, grid, image_);
  } else {
    projector_->project(floats, chosen_, grid, image_);
  }
  if (image_.cells() > most_cells(cloud.size)) return list_as_extras();
  // Otherwise the grid's own bound on angular errors and the step of ranges are enough.
  if (image_.motion || !image_.azimuth_residual.empty()) keep_bound();
}

// Lists the points that the crop leaves, where it takes any.
void Encoder::choose(SweepCounts& counts) {
  chosen_.clear();
  if (!crops(crop_)) return;
  for (std::uint32_t i = 0; i < x_.size(); ++i) {
    const float range = std::sqrt(x_[i] * x_[i] + y_[i] * y_[i] + z_[i] * z_[i]);
    if (range > 0.0F && is_cropped(crop_, x_[i], y_[i], z_[i], range)) {
      ++counts.cropped;
    } else {
      chosen_.push_back(i);
    }
  }
}

// A sweep without an image.
void Encoder::list_as_extras() {
  image_ = {};
  for (std::uint32_t i = 0; i < (crops(crop_) ? chosen_.size() : x_.size()); ++i) {
    image_.extras.push_back({crops(crop_) ? chosen_[i] : i, ExtraReason::stray});
  }
}

// Moves to the extras what would miss the bound once its range is rounded, and what is too near.
void Encoder::keep_bound() {
  unprojector_->unproject(image_, placed_);
  const std::vector<BeamGeometry> beams = beam_geometry(*model_);
  const double along = 0.5 * range_step(options_) / kRangeUnits;
  // A hundredth is kept back: a deskewed point's beam is a little off the direction taken below.
  const double bound = 0.99 * options_.max_error_m * options_.max_error_m;
  const bool mounted = mount_of(*model_, image_.motion) != Mount{};
  const Twist<double> mount(mount_of(*model_, image_.motion));
  std::size_t at = 0;
  for (std::size_t cell = 0; cell < image_.cells(); ++cell) {
    if (image_.range[cell] == 0) continue;
    const std::uint32_t point = image_.point[cell];
    std::array<double, 3> placed{placed_.x[at], placed_.y[at], placed_.z[at]};
    std::array<double, 3> wanted{x_[point], y_[point], z_[point]};
    ++at;
    if (mounted) {  // beams are straight lines from the sensor's own place
      placed = mount.undo(placed, 1.0);
      wanted = mount.undo(wanted, 1.0);
    }
    const double px = placed[0];
    const double py = placed[1];
    const double dx = px - wanted[0];
    const double dy = py - wanted[1];
    const double dz = placed[2] - wanted[2];
    // The rounding moves the point along its beam by up to half a step, either way.
    const BeamGeometry& beam = beams[cell / static_cast<std::size_t>(image_.cols)];
    const double rho = std::sqrt(px * px + py * py);
    const double inward =
        ((dx * px + dy * py) / (rho > 1e-4 ? rho : 1.0) + dz * beam.tan) * beam.inverse_slant;
    const double worst =
        dx * dx + dy * dy + dz * dz + along * along + 2.0 * along * std::abs(inward);
    if (worst <= bound && image_.range[cell] >= kNearest && image_.range[cell] <= kFarthest) {
      continue;
    }
    image_.range[cell] = 0;
    image_.extras.push_back({point, ExtraReason::misfit});
  }
}

void Encoder::plan_layers() {
  set_plan(*model_, image_.cols, kBaseRows, kBaseCols, plan_);
  plan_.effort = options_.effort;
  plan_.quality.assign(static_cast<std::size_t>(LayerCoder::layers(plan_)),
                       {range_step(options_), -1});
  const bool residuals = !image_.azimuth_residual.empty();
  range_.resize(image_.cells());
  azimuth_.resize(residuals ? image_.cells() : 0);
  height_.resize(residuals ? image_.cells() : 0);
  for_each_aligned(*model_, image_, [&](int /*row*/, std::size_t cell, std::size_t aligned) {
    range_[aligned] = image_.range[cell];
    if (!residuals) return;
    azimuth_[aligned] = image_.azimuth_residual[cell];
    height_[aligned] = image_.height_residual[cell];
  });
}

void Encoder::write_model_part(PartList& parts) {
  if (!model_ || frames_since_model_ < options_.model_interval) {
    ++frames_since_model_;
    return;
  }
  frames_since_model_ = 1;
  ByteWriter out = parts.begin(static_cast<std::uint8_t>(Part::model));
  write_model(*model_, out);
}

void Encoder::write_grid(PartList& parts) {
  ByteWriter out = parts.begin(static_cast<std::uint8_t>(Part::grid));
  out.put_varint(as_unsigned(image_.cols));
  if (image_.cols > 0) {
    out.put(model_id_);
    out.put(static_cast<std::uint8_t>(plan_.effort));
    out.put(static_cast<std::uint8_t>(kBaseRows));
    out.put(static_cast<std::uint8_t>(kBaseCols));
    for (const LayerQuality& quality : plan_.quality) {
      out.put_varint(as_unsigned(quality.step));
      out.put_signed(quality.tolerance);
    }
    const bool residuals = !image_.azimuth_residual.empty();
    out.put_varint(residuals ? as_unsigned(image_.azimuth_divisor) : 0U);
    out.put_varint(as_unsigned(image_.height_step));
    out.put(static_cast<std::uint8_t>(image_.motion ? 1 : 0));
    if (image_.motion) write_motion(*image_.motion, out);
  }
  if (image_.cols == 0) return;
  parts.begin(static_cast<std::uint8_t>(Part::firings));
  write_firings(image_.firing_tick, parts.bytes());
}

void Encoder::write_extras(PartList& parts, SweepCounts& counts) {
  lattice_.clear();
  extra_points_.clear();
  const std::int32_t step = extras_step(options_);
  const double per_metre = double{kRangeUnits} / step;
  for (const ExtraPoint& extra : image_.extras) {
    if (extra.reason == ExtraReason::not_finite) {
      ++counts.not_finite;
      continue;
    }
    LatticePoint place{};
    bool inside = true;
    const std::array<double, 3> xyz{x_[extra.point], y_[extra.point], z_[extra.point]};
    if (!(std::isfinite(xyz[0]) && std::isfinite(xyz[1]) && std::isfinite(xyz[2]))) {
      ++counts.not_finite;
      continue;
    }
    if (xyz[0] == 0.0 && xyz[1] == 0.0 && xyz[2] == 0.0) {
      ++counts.zero_range;
      continue;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double steps = std::floor(xyz[axis] * per_metre + 0.5);
      inside = inside && std::abs(steps) < kLatticeLimit;
      place[axis] = inside ? static_cast<std::int32_t>(steps) : 0;
    }
    if (inside) {
      lattice_.push_back(place);
      extra_points_.push_back(extra.point);
    } else {
      ++counts.out_of_view;
    }
  }
  counts.points_coded += static_cast<std::uint32_t>(lattice_.size());
  if (lattice_.empty()) return;
  ByteWriter out = parts.begin(static_cast<std::uint8_t>(Part::extras));
  out.put_varint(lattice_.size());
  out.put_varint(as_unsigned(step));
  sort_for_octree(lattice_, extra_points_);
  write_octree(lattice_, parts.bytes());
}

}  // namespace sweepcast::beam
