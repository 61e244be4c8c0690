#include "codec/beam/sweep_imager.hpp"

#include <array>
#include <cmath>

#include "codec/beam/error_bound.hpp"
#include "codec/beam/model_bytes.hpp"
#include "codec/beam/plane.hpp"
#include "codec/beam/range_layers.hpp"
#include "core/bytes.hpp"
#include "core/crc32.hpp"
#include "sensor/beam_geometry.hpp"
#include "sensor/crop.hpp"
#include "sensor/motion.hpp"

namespace sweepcast::beam {

void SweepImager::learn_model(const CloudView& cloud) {
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
  beams_ = beam_geometry(*model_);
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  write_model(*model_, out);
  model_id_ = crc32(bytes);
}

void SweepImager::project(const CloudView& cloud, double max_error_m, SweepCounts& counts) {
  if (!model_ && sweeps_to_wait_-- == 0) learn_model(cloud);
  x_.resize(cloud.size);
  y_.resize(cloud.size);
  z_.resize(cloud.size);
  cloud.x.read(0, x_);
  cloud.y.read(0, y_);
  cloud.z.read(0, z_);
  choose(counts);
  if (!model_) return move_all();
  BeamGridOptions grid;
  grid.max_error_m = kAngularShare * max_error_m;
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
  if (image_.cells() > most_cells(cloud.size)) return move_all();
  // Otherwise the grid's own bound on angular errors and the step of ranges are enough.
  const bool mounted = mount_of(*model_, image_.motion) != Mount{};
  if (image_.motion || mounted || !image_.azimuth_residual.empty()) keep_bound(max_error_m);
}

// Lists the points that the crop leaves, where it takes any.
void SweepImager::choose(SweepCounts& counts) {
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
void SweepImager::move_all() {
  image_ = {};
  for (std::uint32_t i = 0; i < (crops(crop_) ? chosen_.size() : x_.size()); ++i) {
    image_.extras.push_back({crops(crop_) ? chosen_[i] : i, ExtraReason::stray});
  }
}

void SweepImager::move_nearer(std::int32_t range) {
  for (std::size_t cell = 0; cell < image_.cells(); ++cell) {
    if (image_.range[cell] == 0 || image_.range[cell] >= range) continue;
    image_.range[cell] = 0;
    image_.extras.push_back({image_.point[cell], ExtraReason::misfit});
  }
}

// Moves to the extras what would miss the bound once its range is rounded, and what is too near.
void SweepImager::keep_bound(double max_error_m) {
  unprojector_->unproject(image_, placed_);
  const double along = 0.5 * range_step(max_error_m) / kRangeUnits;
  // A hundredth is kept back: a deskewed point's beam is a little off the direction taken below.
  const double bound = 0.99 * max_error_m * max_error_m;
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
    const BeamGeometry& beam = beams_[cell / static_cast<std::size_t>(image_.cols)];
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

}  // namespace sweepcast::beam
