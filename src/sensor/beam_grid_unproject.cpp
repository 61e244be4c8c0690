// Range image -> cloud; beam_grid.cpp has the other way.
#include <algorithm>
#include <cmath>

#include "core/trig.hpp"
#include "sensor/beam_grid.hpp"
#include "sensor/motion.hpp"

namespace sweepcast {
namespace {}  // namespace

BeamUnprojector::BeamUnprojector(const SensorModel& model)
    : model_(model), beams_(beam_geometry(model)) {}

void BeamUnprojector::unproject(const BeamImage& image, PointCloud& cloud) {
  const auto cols = static_cast<std::size_t>(image.cols);
  sin_.resize(cols);
  cos_.resize(cols);
  for (std::size_t j = 0; j < cols; ++j) {
    const SinCos at = sin_cos(kTwoPi * image.firing_tick[j] / model_.ticks_per_turn);
    sin_[j] = at.sin;
    cos_[j] = at.cos;
  }
  const auto cells = std::count_if(image.range.begin(), image.range.end(),
                                   [](std::int32_t range) { return range != 0; });
  cloud.resize_xyz(static_cast<std::size_t>(cells));
  for (auto* column : {&x_, &y_, &z_}) column->resize(cols);
  std::size_t count = 0;
  for (int k = 0; k < image.rows; ++k) {
    const std::int32_t* range = image.range.data() + static_cast<std::size_t>(k) * cols;
    decode_row(image, k);
    for (std::size_t j = 0; j < cols; ++j) {
      if (range[j] == 0) continue;
      cloud.x[count] = x_[j];
      cloud.y[count] = y_[j];
      cloud.z[count] = z_[j];
      ++count;
    }
  }
}

// All cells of a row, empty ones too: no branches, so that it vectorises.
void BeamUnprojector::decode_row(const BeamImage& image, int k) {
  const auto cols = static_cast<std::size_t>(image.cols);
  const std::size_t first = static_cast<std::size_t>(k) * cols;
  const std::int32_t* range = image.range.data() + first;
  const BeamGeometry& beam = beams_[static_cast<std::size_t>(k)];
  const SinCos turn = sin_cos(beam.azimuth);
  const double rho_per_range = beam.inverse_slant / kRangeUnits;
  for (std::size_t j = 0; j < cols; ++j) {
    const double rho = range[j] * rho_per_range;
    // Sine of the angle by which the lateral offset turns the point; at most 1.
    const double ratio = beam.lateral_m / (rho > 1e-4 ? rho : 1.0);
    const double aside = ratio > 1.0 ? 1.0 : (ratio < -1.0 ? -1.0 : ratio);
    const double ahead = std::sqrt(1.0 - aside * aside);
    const double c = cos_[j] * turn.cos - sin_[j] * turn.sin;
    const double s = sin_[j] * turn.cos + cos_[j] * turn.sin;
    x_[j] = static_cast<float>(rho * (c * ahead - s * aside));
    y_[j] = static_cast<float>(rho * (s * ahead + c * aside));
    z_[j] = static_cast<float>(rho * beam.tan + beam.height_m);
  }
  if (!image.held.empty()) hold(image, k);
  if (!image.azimuth_residual.empty()) add_residuals(image, k);
  if (image.motion) redo_motion(image, k);
  if (const Mount& mount = mount_of(model_, image.motion); mount != Mount{}) redo_mount(mount);
}

// Turns the points of held firings back by what was not interpolated.
void BeamUnprojector::hold(const BeamImage& image, int k) {
  const std::int32_t ticks = model_.beams[static_cast<std::size_t>(k)].interpolated;
  if (ticks == 0) return;
  const SinCos back = sin_cos(-kTwoPi * ticks / model_.ticks_per_turn);
  for (std::size_t j = 0; j < x_.size(); ++j) {
    if (image.held[j] == 0) continue;
    const double x = x_[j];
    const double y = y_[j];
    x_[j] = static_cast<float>(x * back.cos - y * back.sin);
    y_[j] = static_cast<float>(y * back.cos + x * back.sin);
  }
}

void BeamUnprojector::add_residuals(const BeamImage& image, int k) {
  const auto cols = static_cast<std::size_t>(image.cols);
  const std::size_t first = static_cast<std::size_t>(k) * cols;
  const double unit = kTwoPi / (static_cast<double>(model_.ticks_per_turn) * image.azimuth_divisor);
  const double step = static_cast<double>(image.height_step) / kLengthUnits;
  for (std::size_t j = 0; j < cols; ++j) {
    if (image.range[first + j] == 0) continue;
    if (const std::int32_t residual = image.azimuth_residual[first + j]; residual != 0) {
      const SinCos turn = sin_cos(residual * unit);
      const double x = x_[j];
      const double y = y_[j];
      x_[j] = static_cast<float>(x * turn.cos - y * turn.sin);
      y_[j] = static_cast<float>(y * turn.cos + x * turn.sin);
    }
    z_[j] = static_cast<float>(z_[j] + image.height_residual[first + j] * step);
  }
}

void BeamUnprojector::redo_motion(const BeamImage& image, int k) {
  const auto cols = static_cast<std::size_t>(image.cols);
  const std::int32_t* range = image.range.data() + static_cast<std::size_t>(k) * cols;
  const BeamGeometry& beam = beams_[static_cast<std::size_t>(k)];
  const std::int32_t ticks = model_.ticks_per_turn;
  // Ticks from the motion's zero to the beam's own at firing tick 0, in [0, ticks).
  std::int32_t ahead =
      (model_.beams[static_cast<std::size_t>(k)].lag - image.motion->zero_tick) % ticks;
  if (ahead < 0) ahead += ticks;
  const Twist<double> twist(*image.motion);
  const double nod = nod_of(*image.motion);
  for (std::size_t j = 0; j < cols; ++j) {
    std::int32_t tick = image.firing_tick[j] + ahead;
    tick = tick >= ticks ? tick - ticks : tick;
    tick = 2 * tick >= ticks ? tick - ticks : tick;
    const double rho = range[j] * beam.inverse_slant / kRangeUnits;
    const double aside = lateral_turns(beam, rho);
    const double time = (tick + beam.phase) / ticks + aside + beam.time_turns;
    const auto q = twist.redo({x_[j], y_[j], z_[j] + nod * rho}, time);
    x_[j] = static_cast<float>(q[0]);
    y_[j] = static_cast<float>(q[1]);
    z_[j] = static_cast<float>(q[2]);
  }
}

void BeamUnprojector::redo_mount(const Mount& mount) {
  const Twist<double> twist(mount);
  for (std::size_t j = 0; j < x_.size(); ++j) {
    const auto q = twist.redo({x_[j], y_[j], z_[j]}, 1.0);
    x_[j] = static_cast<float>(q[0]);
    y_[j] = static_cast<float>(q[1]);
    z_[j] = static_cast<float>(q[2]);
  }
}

}  // namespace sweepcast
