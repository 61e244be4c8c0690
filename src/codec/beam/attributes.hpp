// Intensity, ring and time of a sweep's points: from the cloud's columns into parts, and back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/beam/attribute_coder.hpp"
#include "codec/frame_layout.hpp"
#include "sensor/beam_grid.hpp"
#include "sweepcast/cloud.hpp"
#include "sweepcast/encoder.hpp"
#include "sweepcast/sensor_model.hpp"

namespace sweepcast::beam {

/// The encoder's side. Per sweep: `read`, `begin`, `write_extras`, then `write_layer` after each
/// layer of ranges. Writes nothing where there is nothing to code.
class AttributeEncoder {
 public:
  /// Takes the columns that the options ask for and the cloud has.
  void read(const CloudView& cloud, const BeamOptions& options);

  /// Writes what comes before the first point. `plan` is null where the sweep has no image; else
  /// `range` is the coded image's plane, `first_col` as `find_first_columns` gives it.
  void begin(const BeamImage& image, const LayerPlan* plan, std::span<const std::int32_t> first_col,
             std::span<const std::int32_t> range, PartList& parts);
  /// `points`: indices into the cloud, in the order in which the extras are decoded.
  void write_extras(std::span<const std::uint32_t> points, PartList& parts);
  void write_layer(int layer, const LayerCoder& layers, PartList& parts);

 private:
  [[nodiscard]] bool any() const {
    return format_.has_intensity || format_.has_ring || format_.has_time;
  }

  std::vector<float> intensity_;
  AttributeFormat format_;
  AttributeValues points_, cells_, extras_;
  AttributeCoder coder_;
};

/// The decoder's side. Per frame: `begin`, `read_layer` after each layer of ranges, `restore`.
class AttributeDecoder {
 public:
  /// Reads what comes before the first point, and the attributes of `extras` points without a
  /// cell. Errors: truncated, corrupt.
  [[nodiscard]] Status begin(std::span<const std::byte> frame, const FrameHeader& header,
                             const LayerPlan* plan, std::span<const std::int32_t> first_col,
                             std::size_t extras);
  /// Whether the attributes of a layer are there, or not meant to be.
  /// Errors: truncated, corrupt.
  [[nodiscard]] Status check_layer(std::span<const std::byte> frame, const FrameHeader& header,
                                   int layer) const;
  /// Errors: as `check_layer`.
  [[nodiscard]] Status read_layer(std::span<const std::byte> frame, const FrameHeader& header,
                                  int layer, const LayerCoder& layers);
  /// Fills the optional columns of `cloud`, whose points are there already: the points of `image`
  /// row by row, then the extras, have their places in `slots`.
  void restore(const BeamImage& image, std::span<const std::uint32_t> slots,
               PointCloud& cloud) const;

 private:
  void put(const AttributeValues& values, std::size_t from, std::size_t to,
           PointCloud& cloud) const;

  bool any_ = false;
  AttributeFormat format_;
  std::vector<std::int32_t> first_col_;
  AttributeValues cells_, extras_;
  AttributeCoder coder_;
};

}  // namespace sweepcast::beam
