// Range images as layers, coarsest first: each is a range-coded piece of bytes that adds cells.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "codec/beam/lattice.hpp"
#include "codec/beam/plane.hpp"
#include "codec/beam/prediction.hpp"
#include "sweepcast/encoder.hpp"

namespace sweepcast::beam {

/// Cells that an image of a sweep of so many points may have; a sweep that would need more has no
/// image. So a decoder allocates no more than a few hundred bytes for each point announced.
[[nodiscard]] constexpr std::size_t most_cells(std::size_t points) {
  return std::min((std::size_t{1} << 20) + 16 * points, std::size_t{1} << 24);
}

/// How well a layer is coded.
struct LayerQuality {
  std::int32_t step = 1;        ///< of ranges, 0.1 mm: they decode within half of it
  std::int32_t tolerance = -1;  ///< cells that interpolation gets as near may be left out; -1: none
};

/// What encoder and decoder must agree on.
struct LayerPlan {
  int rows = 0;
  int cols = 0;
  Effort effort = Effort::normal;
  bool former_best = false;  ///< effort `best` as frames had it at first: to decode them
  Stages stages{};
  std::vector<LatticeStep> lattice;     ///< from the base on
  std::vector<LayerQuality> quality;    ///< of each layer; the first is never thinned
  std::vector<std::int32_t> elevation;  ///< rows values: tangent of each row's beam, falling
};

/// The byte of a frame that tells how its layers are coded.
[[nodiscard]] constexpr std::uint8_t coding_of(const LayerPlan& plan) {
  constexpr std::uint8_t kDeepCoding = 3;
  if (plan.effort == Effort::best && !plan.former_best) return kDeepCoding;
  return static_cast<std::uint8_t>(plan.effort);
}
/// Sets what it tells; false where there is no such coding.
[[nodiscard]] constexpr bool set_coding(std::uint8_t coding, LayerPlan& plan) {
  constexpr std::uint8_t kFormerBest = 2;
  plan.former_best = coding == kFormerBest;
  plan.effort = static_cast<Effort>(std::min(coding, kFormerBest));
  return coding == coding_of(plan);
}

/// The values of an image, row-major; the residuals are empty where there are none.
struct LayerValues {
  std::span<const std::int32_t> range;    ///< 0.1 mm, 0 where empty
  std::span<const std::int32_t> azimuth;  ///< residuals, as in BeamImage
  std::span<const std::int32_t> height;
};

/// The same, to be filled.
struct LayerResiduals {
  std::span<std::int32_t> azimuth;
  std::span<std::int32_t> height;
};

/// Codes the layers of one image. Layer 0 has the base and all rows of its columns; each further
/// layer the columns half way between. The models learn from layer to layer, so layers are coded
/// and decoded in order; any number of the first ones decodes by itself.
class LayerCoder {
 public:
  /// Begins an image: every cell unknown.
  void begin(const LayerPlan& plan);

  /// Layers of a plan.
  [[nodiscard]] static int layers(const LayerPlan& plan);

  /// Appends layer `layer` to `out`.
  void encode(int layer, const LayerValues& values, std::vector<std::byte>& out);

  /// Reads layer `layer`: ranges into the image, residuals into `residuals`, where it has room for
  /// them. False where the bytes end too early to be right.
  [[nodiscard]] bool decode(int layer, std::span<const std::byte> bytes,
                            const LayerResiduals& residuals);

  /// Measured points of the layers so far.
  [[nodiscard]] std::size_t measured() const;

  /// The image after the layers so far, rows x cols: ranges, 0 where there is none, and states.
  void read(std::vector<std::int32_t>& range, std::vector<CellState>& state) const;

  LayerCoder();
  LayerCoder(LayerCoder&&) noexcept;
  LayerCoder& operator=(LayerCoder&&) noexcept;
  ~LayerCoder();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sweepcast::beam
