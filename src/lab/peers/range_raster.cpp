#include "lab/peers/range_raster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "sweepcast/sensor_model.hpp"

namespace sweepcast::lab {
namespace {

constexpr double kTangentSteps = 65536.0;
constexpr std::int64_t kMaxTangent = std::int64_t{100} * 65536;
constexpr std::int64_t kMaxHeightMm = 10'000;
constexpr std::uint64_t kMaxUnitUm = 1'000'000;
constexpr double kMaxRange = 1000.0;  // metres
constexpr std::uint32_t kUnitUm = 2000;
constexpr double kMaxElevation = 89.0 * std::numbers::pi / 180.0;

/// A row's cone in doubles.
struct Cone {
  double tangent, cosine, height;

  explicit Cone(const RasterRow& row)
      : tangent(row.tan_elevation / kTangentSteps),
        cosine(1.0 / std::sqrt(1.0 + tangent * tangent)),
        height(row.height_mm * 1e-3) {}
};

std::vector<Cone> cones_of(const RangeRaster& raster) {
  return {raster.rows.begin(), raster.rows.end()};
}

std::size_t nearest_cone(const std::vector<Cone>& cones, double rho, double z) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < cones.size(); ++i) {
    const double miss = std::abs(z - cones[i].height - rho * cones[i].tangent) * cones[i].cosine;
    if (miss < least) {
      least = miss;
      best = i;
    }
  }
  return best;
}

/// A point's cell, and its range in metres: 0 where it has none.
struct Sample {
  std::size_t cell = 0;
  float range = 0.0F;
};

Sample sample_of(const std::vector<Cone>& cones, std::size_t columns,
                 const std::array<double, 3>& p) {
  const double rho = std::hypot(p[0], p[1]);
  if (!(rho + std::abs(p[2]) <= kMaxRange)) return {};
  const std::size_t row = nearest_cone(cones, rho, p[2]);
  const double turn = std::atan2(p[1], p[0]) / (2.0 * std::numbers::pi) + 0.5;
  const auto column =
      std::min(columns - 1, static_cast<std::size_t>(turn * static_cast<double>(columns)));
  return {row * columns + column, static_cast<float>(std::hypot(rho, p[2] - cones[row].height))};
}

RasterRow to_row(double tangent, double height) {
  return {static_cast<std::int32_t>(std::lround(std::clamp(tangent, -99.0, 99.0) * kTangentSteps)),
          static_cast<std::int32_t>(std::lround(height * 1e3))};
}

}  // namespace

std::vector<RasterRow> uniform_rows(const PointCloud& cloud, int count) {
  double low = kMaxElevation;
  double high = -kMaxElevation;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double elevation =
        std::atan2(double{cloud.z[i]}, std::hypot(double{cloud.x[i]}, double{cloud.y[i]}));
    if (!(std::abs(elevation) <= kMaxElevation)) continue;
    low = std::min(low, elevation);
    high = std::max(high, elevation);
  }
  if (low > high) low = high = 0.0;
  std::vector<RasterRow> rows;
  rows.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    rows.push_back(to_row(std::tan(high - (high - low) * (i + 0.5) / count), 0.0));
  }
  return rows;
}

std::vector<RasterRow> beam_rows(const PointCloud& cloud) {
  const CloudView view(cloud);
  const auto estimate = estimate_sensor_model({&view, 1});
  if (!estimate) return uniform_rows(cloud, 64);
  std::vector<RasterRow> rows;
  for (const Beam& beam : estimate->model.beams) {
    rows.push_back(to_row(static_cast<double>(beam.tan_elevation) / kTangentUnits,
                          static_cast<double>(beam.height) / kLengthUnits));
  }
  return rows;
}

void draw(const PointCloud& cloud, RangeRaster& raster) {
  const auto cones = cones_of(raster);
  std::vector<float> nearest(cones.size() * raster.columns, 0.0F);
  float farthest = 0.0F;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Sample sample = sample_of(cones, raster.columns, {cloud.x[i], cloud.y[i], cloud.z[i]});
    if (sample.range <= 0.0F) continue;
    float& range = nearest[sample.cell];
    range = range > 0.0F ? std::min(range, sample.range) : sample.range;
    farthest = std::max(farthest, sample.range);
  }
  raster.unit_um =
      std::max(kUnitUm, static_cast<std::uint32_t>(std::ceil(double{farthest} * 1e6 / 65535.0)));
  const double per_metre = 1e6 / raster.unit_um;
  raster.ranges.resize(nearest.size());
  std::transform(nearest.begin(), nearest.end(), raster.ranges.begin(), [&](float range) {
    if (range <= 0.0F) return std::uint16_t{0};
    const double units = std::round(double{range} * per_metre);
    return static_cast<std::uint16_t>(std::clamp(units, 1.0, 65535.0));
  });
}

void to_cloud(const RangeRaster& raster, std::uint32_t least, PointCloud& cloud) {
  cloud.clear();
  std::vector<std::array<double, 2>> directions(raster.columns);
  for (std::size_t i = 0; i < raster.columns; ++i) {
    const double turn = (static_cast<double>(i) + 0.5) / static_cast<double>(raster.columns) - 0.5;
    directions[i] = {std::cos(2.0 * std::numbers::pi * turn),
                     std::sin(2.0 * std::numbers::pi * turn)};
  }
  const double unit = raster.unit_um * 1e-6;
  const std::uint16_t* range = raster.ranges.data();
  for (const Cone& cone : cones_of(raster)) {
    for (const auto& direction : directions) {
      const std::uint16_t value = *range++;
      if (value == 0 || value < least) continue;
      const double rho = value * unit * cone.cosine;
      cloud.x.push_back(static_cast<float>(rho * direction[0]));
      cloud.y.push_back(static_cast<float>(rho * direction[1]));
      cloud.z.push_back(static_cast<float>(rho * cone.tangent + cone.height));
    }
  }
}

namespace {

void fill_row(std::span<std::uint16_t> row) {
  const std::size_t none = row.size();
  std::size_t left = none;
  for (std::size_t i = 0; i < row.size();) {
    if (row[i] != 0) {
      left = i++;
      continue;
    }
    std::size_t right = i;
    while (right < row.size() && row[right] == 0) ++right;
    const int from = left != none ? row[left] : row[right];
    const bool slopes = left != none && right < row.size();
    const int rise = slopes ? row[right] - from : 0;
    const auto steps = static_cast<int>(right - i) + 1;
    for (int step = 1; i < right; ++i, ++step) {
      row[i] = static_cast<std::uint16_t>(from + rise * step / steps);
    }
  }
}

}  // namespace

void fill_gaps(std::size_t columns, std::vector<std::uint16_t>& ranges) {
  for (std::size_t begin = 0; begin < ranges.size(); begin += columns) {
    const auto row = std::span(ranges).subspan(begin, columns);
    if (std::any_of(row.begin(), row.end(), [](std::uint16_t range) { return range != 0; })) {
      fill_row(row);
    } else if (begin > 0) {
      std::copy_n(ranges.data() + begin - columns, columns, row.data());
    }
  }
}

void write_head(const RangeRaster& raster, ByteWriter& writer) {
  writer.put_varint(raster.rows.size());
  writer.put_varint(raster.columns);
  writer.put_varint(raster.unit_um);
  RasterRow last;
  for (const RasterRow& row : raster.rows) {
    writer.put_signed(row.tan_elevation - last.tan_elevation);
    writer.put_signed(row.height_mm - last.height_mm);
    last = row;
  }
}

bool read_head(ByteReader& reader, RangeRaster& raster) {
  raster.rows.resize(reader.get_varint(kMaxRasterRows));
  raster.columns = reader.get_varint(kMaxRasterColumns);
  raster.unit_um = static_cast<std::uint32_t>(reader.get_varint(kMaxUnitUm));
  std::int64_t tangent = 0;
  std::int64_t height = 0;
  for (RasterRow& row : raster.rows) {
    // Each is bounded before the next is added, so that no sum overflows.
    tangent += std::clamp(reader.get_signed(), -2 * kMaxTangent - 1, 2 * kMaxTangent + 1);
    height += std::clamp(reader.get_signed(), -2 * kMaxHeightMm - 1, 2 * kMaxHeightMm + 1);
    if (std::abs(tangent) > kMaxTangent || std::abs(height) > kMaxHeightMm) return false;
    row = {static_cast<std::int32_t>(tangent), static_cast<std::int32_t>(height)};
  }
  if (!reader.ok() || raster.rows.empty() || raster.columns == 0 || raster.unit_um == 0) {
    return false;
  }
  raster.ranges.assign(raster.rows.size() * raster.columns, 0);
  return true;
}

}  // namespace sweepcast::lab
