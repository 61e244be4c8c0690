// Codes the attributes of an image's points, layer by layer, and those of points without a cell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "codec/beam/attribute_format.hpp"
#include "codec/beam/range_layers.hpp"

namespace sweepcast::beam {

/// Follows a `LayerCoder`: after layer k of ranges comes layer k of attributes, which has the
/// attributes of exactly the points that the layer added. The models learn from layer to layer.
class AttributeCoder {
 public:
  /// Begins a sweep. `plan` is that of its layers, or null where it has no image;
  /// `first_col[row]` is where the row's firing 0 stands in the coded image.
  void begin(const AttributeFormat& format, const LayerPlan* plan,
             std::span<const std::int32_t> first_col);

  /// Appends the attributes of layer `layer`, which `layers` has just coded. `cells` has an entry
  /// for each cell of the coded image, row-major; coding leaves them as they are.
  void encode(int layer, const LayerCoder& layers, AttributeValues& cells,
              std::vector<std::byte>& out);
  /// The inverse: fills entries of `cells`. False where the bytes end too early.
  [[nodiscard]] bool decode(int layer, const LayerCoder& layers, std::span<const std::byte> bytes,
                            AttributeValues& cells);

  /// Appends the attributes of the points without a cell, in the order in which they are decoded.
  void encode_extras(AttributeValues& extras, std::vector<std::byte>& out);
  /// The inverse: fills `extras`, which has an entry for each.
  [[nodiscard]] bool decode_extras(std::span<const std::byte> bytes, AttributeValues& extras);

  AttributeCoder();
  AttributeCoder(AttributeCoder&&) noexcept;
  AttributeCoder& operator=(AttributeCoder&&) noexcept;
  ~AttributeCoder();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sweepcast::beam
