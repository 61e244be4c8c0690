#include "sensor/spherical_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/trig.hpp"
#include "sensor/crop.hpp"

namespace sweepcast {
namespace {

constexpr double kMicroDegree = kDegree * 1e-6;  // radians
constexpr int kOffsetUnits = 256;                // of a step

std::int32_t micro_degrees(double degrees) {
  return static_cast<std::int32_t>(std::lround(degrees * 1e6));
}

int steps_in(std::int64_t span, std::int64_t step) {
  return static_cast<int>((span + step - 1) / step);
}

}  // namespace

/// Points are taken in batches that stay in the first-level cache and that compilers vectorise.
struct SphericalProjector::Batch {
  static constexpr std::size_t kCapacity = 512;
  std::size_t size = 0;
  std::array<float, kCapacity> x, y, z;
  std::array<float, kCapacity> range;           // metres
  std::array<float, kCapacity> column, height;  // in steps from column 0 and row 0
};

SphericalProjector::SphericalProjector(const RcpccOptions& options, const Crop& crop)
    : crop_(crop),
      collision_(options.collision),
      max_range_(static_cast<float>(options.max_range_m)) {
  view_.azimuth_min = micro_degrees(options.azimuth_min_deg);
  view_.azimuth_step = micro_degrees(options.params.azimuth_step_deg);
  view_.elevation_min = micro_degrees(options.elevation_min_deg);
  view_.elevation_step = micro_degrees(options.params.elevation_step_deg);
  std::int64_t width = std::int64_t{micro_degrees(options.azimuth_max_deg)} - view_.azimuth_min;
  while (width <= 0) width += 360'000'000;  // the view crosses +-180 degrees
  view_.cols = steps_in(width, view_.azimuth_step);
  view_.rows =
      steps_in(std::int64_t{micro_degrees(options.elevation_max_deg)} - view_.elevation_min,
               view_.elevation_step);
}

void SphericalProjector::project(const CloudView& cloud, RangeImage& image, SweepCounts& counts) {
  counts = {};
  counts.points_in = static_cast<std::uint32_t>(cloud.size);
  samples_.clear();
  samples_.reserve(cloud.size);
  Batch batch;
  for (std::size_t begin = 0; begin < cloud.size; begin += batch.size) {
    batch.size = std::min(Batch::kCapacity, cloud.size - begin);
    to_spherical(cloud, begin, batch);
    collect(batch, counts);
  }
  scatter(image, counts);
}

void SphericalProjector::to_spherical(const CloudView& cloud, std::size_t begin,
                                      Batch& batch) const {
  cloud.x.read(begin, std::span(batch.x).first(batch.size));
  cloud.y.read(begin, std::span(batch.y).first(batch.size));
  cloud.z.read(begin, std::span(batch.z).first(batch.size));
  const auto per_radian = [](std::int32_t step) {
    return static_cast<float>(1.0 / (kMicroDegree * step));
  };
  const auto steps = [](std::int32_t angle, std::int32_t step) {
    return static_cast<float>(static_cast<double>(angle) / step);
  };
  const float columns_per_radian = per_radian(view_.azimuth_step);
  const float rows_per_radian = per_radian(view_.elevation_step);
  const float first_column = steps(view_.azimuth_min, view_.azimuth_step);
  const float first_row = steps(view_.elevation_min, view_.elevation_step);
  const float turn = steps(360'000'000, view_.azimuth_step);
  for (std::size_t i = 0; i < batch.size; ++i) {
    const float x = batch.x[i];
    const float y = batch.y[i];
    const float z = batch.z[i];
    const float flat = x * x + y * y;
    batch.range[i] = std::sqrt(flat + z * z);
    const float column = arc_tangent_fast(y, x) * columns_per_radian - first_column;
    batch.column[i] = column < 0.0F ? column + turn : column;
    batch.height[i] = arc_tangent_fast(z, std::sqrt(flat)) * rows_per_radian - first_row;
  }
}

void SphericalProjector::collect(const Batch& batch, SweepCounts& counts) {
  const auto cols = static_cast<float>(view_.cols);
  const auto rows = static_cast<float>(view_.rows);
  // A full turn may round to a column past the last one, which then is column 0 again.
  const bool full_turn = static_cast<std::int64_t>(view_.cols) * view_.azimuth_step >= 360'000'000;
  // Likewise a point on the view's lowest or highest edge, such as a pole, may round past it.
  constexpr float kSlack = 1.0F / 512;  // steps
  const float top = std::nextafter(rows, 0.0F);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < batch.size; ++i) {
    const float x = batch.x[i];
    const float y = batch.y[i];
    const float z = batch.z[i];
    const float range = batch.range[i];
    if (!(std::abs(x) < kInfinity && std::abs(y) < kInfinity && std::abs(z) < kInfinity)) {
      ++counts.not_finite;
      continue;
    }
    if (range < 0.0005F) {  // rounds to 0 mm, which means empty
      ++counts.zero_range;
      continue;
    }
    if (is_cropped(crop_, x, y, z, range)) {
      ++counts.cropped;
      continue;
    }
    float column = batch.column[i];
    float height = batch.height[i];
    if (height > -kSlack && height < rows + kSlack) height = std::clamp(height, 0.0F, top);
    if (full_turn && column >= cols) column = 0.0F;
    if (!(range <= max_range_ && column < cols && height >= 0.0F && height < rows)) {
      ++counts.out_of_view;
      continue;
    }
    const auto col = static_cast<int>(column);
    const auto row = static_cast<int>(height);
    const auto offset = [](float within) {
      return static_cast<std::int8_t>(static_cast<int>(within * kOffsetUnits) - kOffsetUnits / 2);
    };
    samples_.push_back({static_cast<std::int32_t>(range * 1000.0F + 0.5F),
                        static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(col),
                        offset(column - static_cast<float>(col)),
                        offset(height - static_cast<float>(row))});
  }
}

bool SphericalProjector::wins(const Sample& a, const Sample& b) const {
  if (collision_ == CollisionRule::nearest_range) return a.range_mm < b.range_mm;
  const auto off_centre = [](const Sample& s) {
    return s.azimuth * s.azimuth + s.elevation * s.elevation;
  };
  const int difference = off_centre(a) - off_centre(b);
  return difference < 0 || (difference == 0 && a.range_mm < b.range_mm);
}

void SphericalProjector::scatter(RangeImage& image, SweepCounts& counts) {
  int low = view_.rows;
  int high = -1;
  for (const Sample& sample : samples_) {
    low = std::min<int>(low, sample.row);
    high = std::max<int>(high, sample.row);
  }
  SphericalGrid& grid = image.grid;
  grid = view_;
  grid.rows = high < low ? 0 : high - low + 1;
  grid.elevation_min += (grid.rows == 0 ? 0 : low) * grid.elevation_step;

  winner_.assign(grid.cells(), 0);
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Sample& sample = samples_[i];
    const std::size_t cell =
        static_cast<std::size_t>(sample.row - low) * static_cast<std::size_t>(grid.cols) +
        sample.col;
    std::uint32_t& winner = winner_[cell];
    if (winner != 0) {
      ++counts.collided;
      if (!wins(sample, samples_[winner - 1])) continue;
    }
    winner = static_cast<std::uint32_t>(i) + 1;
  }

  image.range_mm.assign(grid.cells(), 0);
  image.offsets.assign(static_cast<std::size_t>(grid.rows), {});
  for (int r = 0; r < grid.rows; ++r) {
    std::int32_t* ranges = image.row(r);
    const std::uint32_t* winners =
        winner_.data() + static_cast<std::size_t>(r) * static_cast<std::size_t>(grid.cols);
    int azimuth = 0;
    int elevation = 0;
    int count = 0;
    for (int c = 0; c < grid.cols; ++c) {
      if (winners[c] == 0) continue;
      const Sample& sample = samples_[winners[c] - 1];
      ranges[c] = sample.range_mm;
      azimuth += sample.azimuth;
      elevation += sample.elevation;
      ++count;
    }
    counts.points_coded += static_cast<std::uint32_t>(count);
    if (count == 0) continue;
    // Offsets were truncated downwards: half a unit makes the mean unbiased. A mean of 127.5, just
    // below the next cell, must not become 128, which is -128 in a byte.
    const auto mean = [count](int sum) {
      const long rounded = std::lround((static_cast<double>(sum) + 0.5 * count) / count);
      return static_cast<std::int8_t>(std::min(rounded, 127L));
    };
    image.offsets[static_cast<std::size_t>(r)] = {mean(azimuth), mean(elevation)};
  }
}

void SphericalUnprojector::unproject(const RangeImage& image, PointCloud& cloud) {
  const SphericalGrid& grid = image.grid;
  const auto cols = static_cast<std::size_t>(grid.cols);
  sin_.resize(cols);
  cos_.resize(cols);
  for (std::size_t c = 0; c < cols; ++c) {
    const double centre = static_cast<double>(c) + 0.5;
    const SinCos azimuth = sin_cos((grid.azimuth_min + centre * grid.azimuth_step) * kMicroDegree);
    sin_[c] = azimuth.sin;
    cos_[c] = azimuth.cos;
  }
  const auto points = grid.cells() - static_cast<std::size_t>(std::count(image.range_mm.begin(),
                                                                         image.range_mm.end(), 0));
  cloud.clear();
  cloud.resize_xyz(points);
  std::size_t at = 0;
  for (int r = 0; r < grid.rows; ++r) {
    const RowOffset offset = image.offsets[static_cast<std::size_t>(r)];
    const auto angle = [](double steps, std::int32_t step) { return steps * step * kMicroDegree; };
    const SinCos elevation =
        sin_cos(grid.elevation_min * kMicroDegree +
                angle(r + 0.5 + offset.elevation / double{kOffsetUnits}, grid.elevation_step));
    const SinCos turn = sin_cos(angle(offset.azimuth / double{kOffsetUnits}, grid.azimuth_step));
    const std::int32_t* ranges = image.row(r);
    for (std::size_t c = 0; c < cols; ++c) {
      if (ranges[c] == 0) continue;
      const double range = 0.001 * ranges[c];
      const double flat = range * elevation.cos;
      cloud.x[at] = static_cast<float>(flat * (cos_[c] * turn.cos - sin_[c] * turn.sin));
      cloud.y[at] = static_cast<float>(flat * (sin_[c] * turn.cos + cos_[c] * turn.sin));
      cloud.z[at] = static_cast<float>(range * elevation.sin);
      ++at;
    }
  }
}

}  // namespace sweepcast
