// Codec rcpcc: the RCPCC paper's method (section III.B), from cloud to parts of a frame and back.
// docs/rcpcc.md tells where it departs from the text, and why.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "codec/entropy/zstd_coder.hpp"
#include "codec/frame_layout.hpp"
#include "codec/rcpcc/surface.hpp"
#include "codec/rcpcc/unfit.hpp"
#include "core/stage_lap.hpp"
#include "sensor/spherical_grid.hpp"
#include "sweepcast/cloud.hpp"
#include "sweepcast/encoder.hpp"
#include "sweepcast/frame.hpp"

namespace sweepcast::rcpcc {

/// The parts of a frame, in this order.
enum class Part : std::uint8_t {
  grid = 1,       ///< where the cells lie, and the parameters
  occupancy = 2,  ///< which cells hold a point
  surfaces = 3,   ///< the four-tuples
  unfit = 4,      ///< ranges that no surface describes
};

[[nodiscard]] std::string_view part_name(std::uint8_t kind) noexcept;

/// Whether options are in their documented ranges; an error names the option and its range.
[[nodiscard]] Status check(const RcpccOptions& options);

class Encoder {
 public:
  /// Options must have passed `check`.
  Encoder(const RcpccOptions& options, const Crop& crop, StageClock* stages = nullptr);

  /// Fills `parts` and `counts`. Errors: limit (more than 2^24 cells between the lowest and the
  /// highest row with a point).
  [[nodiscard]] Status encode(const CloudView& cloud, PartList& parts, SweepCounts& counts);

  /// Which cells of the image that the last call made are described by surfaces: one byte each.
  [[nodiscard]] const std::vector<std::uint8_t>& fitted() const { return fitted_; }

 private:
  template <class Write>
  void pack(Part part, std::string_view stage, PartList& parts, Write write);

  SurfaceOptions surface_options_;
  UnfitOptions unfit_options_;
  SphericalProjector projector_;
  SurfaceFitter fitter_;
  UnfitCoder unfit_coder_;
  ZstdEncoder zstd_;
  RangeImage image_;
  std::vector<Block> blocks_;
  std::vector<Surface> surfaces_;
  std::vector<std::uint8_t> fitted_;
  std::vector<std::byte> raw_;
  StageClock* stages_;
  StageLap lap_{nullptr};
};

class Decoder {
 public:
  explicit Decoder(StageClock* stages = nullptr) : stages_(stages) {}

  /// Fills `cloud` from a frame whose head is parsed. Errors: truncated, corrupt, limit.
  [[nodiscard]] Status decode(std::span<const std::byte> frame, const FrameHeader& header,
                              PointCloud& cloud);

  /// The image that the last call decoded.
  [[nodiscard]] const RangeImage& image() const { return image_; }

 private:
  [[nodiscard]] bool read_grid();
  [[nodiscard]] Status unpack(std::span<const std::byte> frame, const FrameHeader& header,
                              Part part);

  SurfaceOptions surface_options_;
  UnfitOptions unfit_options_;
  UnfitCoder unfit_coder_;
  ZstdDecoder zstd_;
  RangeImage image_;
  std::vector<Block> blocks_;
  std::vector<Surface> surfaces_;
  std::vector<std::uint8_t> fitted_;
  std::vector<std::byte> raw_;
  SphericalUnprojector unprojector_;
  StageClock* stages_;
  StageLap lap_{nullptr};
};

}  // namespace sweepcast::rcpcc
