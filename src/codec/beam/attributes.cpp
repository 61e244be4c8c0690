#include "codec/beam/attributes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "codec/beam/alignment.hpp"
#include "codec/beam/codec.hpp"

namespace sweepcast::beam {
namespace {

constexpr double kFarthestTime = 9e15;  // ns: 2^53, where doubles are still whole numbers

std::uint8_t layer_kind(int layer) {
  return static_cast<std::uint8_t>(static_cast<int>(Part::layer_attributes) + layer);
}

// What has no time that a number can say counts as 0.
std::int64_t time_of(double nanoseconds) {
  if (!(std::abs(nanoseconds) < kFarthestTime)) return 0;
  return static_cast<std::int64_t>(std::floor(nanoseconds + 0.5));
}

std::uint16_t ring_of(double ring) {
  return static_cast<std::uint16_t>(ring >= 0 && ring <= 65'535 ? ring : 0.0);
}

}  // namespace

void AttributeEncoder::read(const CloudView& cloud, const BeamOptions& options) {
  const bool all = options.fields == Fields::all;
  format_ = {};
  format_.has_intensity = options.fields != Fields::xyz && cloud.intensity.present();
  format_.has_ring = all && cloud.ring.present();
  format_.has_time = all && cloud.time_ns.present();
  points_.resize(cloud.size, format_.has_intensity, format_.has_ring, format_.has_time);
  for (std::size_t i = 0; i < points_.ring.size(); ++i) points_.ring[i] = ring_of(cloud.ring.at(i));
  for (std::size_t i = 0; i < points_.time.size(); ++i) {
    points_.time[i] = time_of(cloud.time_ns.at(i));
  }
  find_time_unit(points_.time, format_);
  for (std::int64_t& time : points_.time) {
    time = (time - format_.time_base) / format_.time_quantum;
  }
  if (!format_.has_intensity) return;
  intensity_.resize(cloud.size);
  cloud.intensity.read(0, intensity_);
  format_.unit = find_unit(intensity_, options.lossless ? 0.0 : options.intensity_step);
  std::transform(intensity_.begin(), intensity_.end(), points_.intensity.begin(),
                 [&](float intensity) { return intensity_value(format_.unit, intensity); });
}

void AttributeEncoder::begin(const SensorModel* model, const BeamImage& image,
                             const LayerPlan* plan, std::span<const std::int32_t> range,
                             PartList& parts) {
  if (!any()) return;
  std::vector<std::int32_t> first_col;
  if (plan != nullptr) {
    first_col = first_columns(*model, image);
    cells_.resize(image.cells(), format_.has_intensity, format_.has_ring, format_.has_time);
    for_each_aligned(*model, image, [&](int /*row*/, std::size_t cell, std::size_t aligned) {
      if (image.range[cell] == 0) return;
      const std::size_t point = image.point[cell];
      if (format_.has_intensity) cells_.intensity[aligned] = points_.intensity[point];
      if (format_.has_ring) cells_.ring[aligned] = points_.ring[point];
      if (format_.has_time) cells_.time[aligned] = points_.time[point];
    });
    fit_tables(*plan, first_col, range, cells_, format_);
  } else {  // an image that was tried before may have left its own
    format_.row_ring.clear();
    format_.row_time.clear();
    format_.col_time.clear();
  }
  parts.begin(static_cast<std::uint8_t>(Part::attributes));
  write_format(format_, parts.bytes());
  coder_.begin(format_, plan, std::move(first_col));
}

void AttributeEncoder::write_extras(std::span<const std::uint32_t> points, PartList& parts) {
  if (!any() || points.empty()) return;
  extras_.resize(points.size(), format_.has_intensity, format_.has_ring, format_.has_time);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (format_.has_intensity) extras_.intensity[i] = points_.intensity[points[i]];
    if (format_.has_ring) extras_.ring[i] = points_.ring[points[i]];
    if (format_.has_time) extras_.time[i] = points_.time[points[i]];
  }
  parts.begin(static_cast<std::uint8_t>(Part::extra_attributes));
  coder_.encode_extras(extras_, parts.bytes());
}

void AttributeEncoder::write_layer(int layer, const LayerCoder& layers, PartList& parts) {
  if (!any()) return;
  parts.begin(layer_kind(layer));
  coder_.encode(layer, layers, cells_, parts.bytes());
}

Status AttributeDecoder::begin(std::span<const std::byte> frame, const FrameHeader& header,
                               const LayerPlan* plan, std::vector<std::int32_t> first_col,
                               std::size_t extras) {
  any_ = has_part(header, static_cast<std::uint8_t>(Part::attributes));
  format_ = {};
  if (!any_) return {};
  const auto bytes = checked_part(frame, header, static_cast<std::uint8_t>(Part::attributes));
  if (!bytes) return tl::unexpected(bytes.error());
  const int rows = plan != nullptr ? plan->rows : 0;
  const int cols = plan != nullptr ? plan->cols : 0;
  if (!read_format(*bytes, rows, cols, format_)) {
    return fail(ErrorCode::corrupt, "the units of the frame's attributes cannot be right");
  }
  first_col_ = std::move(first_col);
  const std::size_t cells = static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  cells_.resize(cells, format_.has_intensity, format_.has_ring, format_.has_time);
  extras_.resize(extras, format_.has_intensity, format_.has_ring, format_.has_time);
  coder_.begin(format_, plan, first_col_);
  if (extras == 0) return {};
  const auto rest = checked_part(frame, header, static_cast<std::uint8_t>(Part::extra_attributes));
  if (!rest) return tl::unexpected(rest.error());
  if (coder_.decode_extras(*rest, extras_)) return {};
  return fail(ErrorCode::corrupt, "the attributes of the frame's extra points end too early");
}

Status AttributeDecoder::check_layer(std::span<const std::byte> frame, const FrameHeader& header,
                                     int layer) const {
  if (!any_) return {};
  const auto bytes = checked_part(frame, header, layer_kind(layer));
  if (!bytes) return tl::unexpected(bytes.error());
  return {};
}

Status AttributeDecoder::read_layer(std::span<const std::byte> frame, const FrameHeader& header,
                                    int layer, const LayerCoder& layers) {
  if (!any_) return {};
  const auto bytes = checked_part(frame, header, layer_kind(layer));
  if (!bytes) return tl::unexpected(bytes.error());
  if (coder_.decode(layer, layers, *bytes, cells_)) return {};
  return fail(ErrorCode::corrupt, "the attributes of a layer of the frame end too early");
}

void AttributeDecoder::put(const AttributeValues& values, std::size_t from, std::size_t to,
                           PointCloud& cloud) const {
  if (format_.has_intensity) {
    cloud.intensity[to] = intensity_of(format_.unit, values.intensity[from]);
  }
  if (format_.has_ring) cloud.ring[to] = values.ring[from];
  if (format_.has_time) {
    cloud.time_ns[to] =
        static_cast<std::int64_t>(static_cast<std::uint64_t>(format_.time_base) +
                                  static_cast<std::uint64_t>(format_.time_quantum) *
                                      static_cast<std::uint64_t>(values.time[from]));
  }
}

void AttributeDecoder::restore(const BeamImage& image, std::span<const std::uint32_t> slots,
                               PointCloud& cloud) const {
  if (!any_) return;
  if (format_.has_intensity) cloud.intensity.assign(cloud.size(), 0.0F);
  if (format_.has_ring) cloud.ring.assign(cloud.size(), 0);
  if (format_.has_time) cloud.time_ns.assign(cloud.size(), 0);
  std::size_t at = 0;
  if (image.cols > 0) {
    const auto cols = static_cast<std::size_t>(image.cols);
    for (std::size_t cell = 0; cell < image.cells(); ++cell) {
      if (image.range[cell] == 0) continue;
      const std::size_t row = cell / cols;
      const std::size_t col =
          (cell - row * cols + static_cast<std::size_t>(first_col_[row])) % cols;
      put(cells_, row * cols + col, slots[at++], cloud);
    }
  }
  const std::size_t extras = slots.size() - at;
  for (std::size_t i = 0; i < extras; ++i) put(extras_, i, slots[at + i], cloud);
}

}  // namespace sweepcast::beam
