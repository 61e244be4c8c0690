// The parts of a frame beside its layers.
#include <cmath>
#include <utility>

#include "codec/beam/alignment.hpp"
#include "codec/beam/codec.hpp"
#include "codec/beam/error_bound.hpp"
#include "codec/beam/model_bytes.hpp"
#include "codec/beam/place_choice.hpp"

namespace sweepcast::beam {
namespace {

constexpr std::size_t kFewExtras = 256;

std::uint64_t as_unsigned(std::int64_t value) {
  return static_cast<std::uint64_t>(value);
}

}  // namespace

void Encoder::write_model_part(PartList& parts) {
  const SensorModel* model = imager_.model();
  if (model == nullptr || imager_.image().cols == 0) return;
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
  if (image.cols == 0) return;
  out.put(imager_.model_id());
  out.put(coding_of(plan_));
  out.put(static_cast<std::uint8_t>(plan_.lattice.front().row_stride));
  out.put(static_cast<std::uint8_t>(plan_.lattice.front().col_stride));
  for (const LayerQuality& quality : plan_.quality) {
    out.put_varint(as_unsigned(quality.step));
    out.put_signed(quality.tolerance);
  }
  const bool residuals = !image.azimuth_residual.empty();
  out.put_varint(residuals ? as_unsigned(image.azimuth_divisor) : 0U);
  out.put_varint(as_unsigned(image.height_step));
  out.put(static_cast<std::uint8_t>(image.motion ? 1 : 0));
  if (image.motion) write_motion(*image.motion, out);
  parts.begin(static_cast<std::uint8_t>(Part::firings));
  firing_coder_.write(image.firing_tick, parts.bytes(), image.held);
}

// Puts the points without a cell on a lattice, and counts those that cannot be coded.
void Encoder::gather_extras(SweepCounts& counts) {
  extra_points_.clear();
  placed_.clear();
  lattice_.clear();
  const double step = static_cast<double>(extras_step(error_m())) / kRangeUnits;
  for (const ExtraPoint& extra : imager_.image().extras) {
    const float x = imager_.x()[extra.point];
    const float y = imager_.y()[extra.point];
    const float z = imager_.z()[extra.point];
    LatticePoint place{};
    if (!(std::isfinite(x) && std::isfinite(y) && std::isfinite(z))) {
      ++counts.not_finite;
    } else if (x == 0.0F && y == 0.0F && z == 0.0F) {
      ++counts.zero_range;
    } else if (!nearest_place({x, y, z}, step, place)) {
      ++counts.out_of_view;
    } else {
      lattice_.push_back(place);
      extra_points_.push_back(extra.point);
      placed_.x.push_back(x);
      placed_.y.push_back(y);
      placed_.z.push_back(z);
    }
  }
  // What is missing to the exact coordinates takes the fewer bytes the less it is. And a few points
  // share no places.
  if (options_.lossless || lattice_.size() < kFewExtras) return;
  choose_places(placed_.x, placed_.y, placed_.z, step, error_m(), lattice_);
}

void Encoder::write_extras(PartList& parts, SweepCounts& counts) {
  gather_extras(counts);
  counts.points_coded += static_cast<std::uint32_t>(lattice_.size());
  if (lattice_.empty()) return;
  ByteWriter out = parts.begin(static_cast<std::uint8_t>(Part::extras));
  out.put_varint(lattice_.size());
  out.put_varint(as_unsigned(extras_step(error_m())));
  octree_.sort(lattice_, extra_points_);
  octree_.write(lattice_, parts.bytes());
}

// What brings back the file's own coordinates and order.
void Encoder::write_original(const CloudView& cloud, PartList& parts) {
  BeamImage& image = imager_.image();
  const bool has_image = image.cols > 0 && imager_.model() != nullptr;
  std::vector<std::int32_t> ranges;
  if (has_image) ranges = take_decoded();
  if (options_.lossless) write_exact_part(ranges, parts);
  if (options_.keep_order) {
    parts.begin(static_cast<std::uint8_t>(Part::order));
    write_order(original_order(cloud.size, cloud.width, image, extra_points_), image,
                extra_points_.size(), parts.bytes());
  }
  if (has_image) give_back();
}

// Puts what the decoder has in the place of the image's ranges: cells that thinning left out have
// none. Gives the true ranges of those that it has, row by row.
std::vector<std::int32_t> Encoder::take_decoded() {
  BeamImage& image = imager_.image();
  std::vector<std::int32_t> decoded, truth;
  std::vector<CellState> state;
  layers_.read(decoded, state);
  for_each_aligned(first_column_, image, [&](std::size_t cell, std::size_t aligned) {
    const bool measured = state[aligned] == CellState::measured;
    if (measured) truth.push_back(image.range[cell]);
    image.range[cell] = measured ? decoded[aligned] : 0;
  });
  return truth;
}

// Undoes it.
void Encoder::give_back() {
  BeamImage& image = imager_.image();
  for_each_aligned(first_column_, image, [&](std::size_t cell, std::size_t aligned) {
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

}  // namespace sweepcast::beam
