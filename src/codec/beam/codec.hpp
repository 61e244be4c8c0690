// Codec beam: the sensor's own geometry. A sweep is a sensor model (sent rarely), a list of firings
// and one range for each point, coded coarse to fine within an error bound.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "codec/beam/attributes.hpp"
#include "codec/beam/exact_coder.hpp"
#include "codec/beam/model_bytes.hpp"
#include "codec/beam/octree.hpp"
#include "codec/beam/point_order.hpp"
#include "codec/beam/range_layers.hpp"
#include "codec/beam/sweep_imager.hpp"
#include "codec/frame_layout.hpp"
#include "core/stage_lap.hpp"
#include "rate/byte_budget.hpp"
#include "sensor/beam_grid.hpp"
#include "sweepcast/cloud.hpp"
#include "sweepcast/encoder.hpp"
#include "sweepcast/sensor_model.hpp"

namespace sweepcast::beam {

/// The parts of a frame. Layers come last, coarsest first, so that a frame may be cut between them.
enum class Part : std::uint8_t {
  model = 1,              ///< the sensor model; in the first frame and from time to time
  grid = 2,               ///< which model, steps, numbers of rows and columns
  firings = 3,            ///< the ticks of the columns
  extras = 4,             ///< points without a cell
  attributes = 5,         ///< units of intensity and time, what beams and firings tell of them
  extra_attributes = 6,   ///< of the points without a cell
  layer = 16,             ///< the first layer of ranges; the others follow with 17, 18, ...
  order = 7,              ///< in which the points came; comes last
  exact = 8,              ///< what is missing to the true coordinates; comes after the layers
  layer_attributes = 32,  ///< of the points that layer 16 adds; the others follow with 33, 34, ...
};

[[nodiscard]] std::string_view part_name(std::uint8_t kind) noexcept;

/// How many layers a frame with this part `grid` was made of; a link may have cut some off.
/// None where the part cannot be right.
[[nodiscard]] std::optional<int> layers_of_grid(std::span<const std::byte> grid);

[[nodiscard]] Status check(const BeamOptions& options);

/// Makes parts of sweeps; keeps its buffers, and the sensor's model from sweep to sweep.
class Encoder {
 public:
  /// Options must have passed `check`.
  Encoder(const BeamOptions& options, const Crop& crop, StageClock* stages = nullptr);

  /// See `sweepcast::Encoder`.
  [[nodiscard]] Status set_target_bytes(std::size_t bytes);

  /// Fills `parts` and `counts`. Unless thinned, every finite point with a range decodes within the
  /// error bound. Error: limit (the sweep does not fit the bytes that options allow;
  /// the message tells how many it takes at its coarsest).
  [[nodiscard]] Status encode(const CloudView& cloud, const SweepInfo& info, PartList& parts,
                              SweepCounts& counts);

 private:
  [[nodiscard]] double error_m() const { return quality_.step_m[0] / 2.0; }
  [[nodiscard]] double projection_error_m() const;
  [[nodiscard]] Status fit_budget(const CloudView& cloud, const SweepInfo& info, PartList& parts,
                                  SweepCounts& counts);
  void write_smallest(const CloudView& cloud, const SweepInfo& info, PartList& parts,
                      SweepCounts& counts);
  void write_sweep(const CloudView& cloud, PartList& parts, SweepCounts& counts);
  void plan_layers();
  void write_model_part(PartList& parts);
  void write_grid(PartList& parts);
  void gather_extras(SweepCounts& counts);
  void write_extras(PartList& parts, SweepCounts& counts);
  void write_layers(PartList& parts, SweepCounts& counts);
  void write_original(const CloudView& cloud, PartList& parts);
  [[nodiscard]] std::vector<std::int32_t> take_decoded();
  void give_back();
  void move_missed();
  void restore_missed();
  void write_exact_part(std::span<const std::int32_t> ranges, PartList& parts);

  /// Which points of the image are extras, because so they take fewer bytes.
  struct ExtrasChoice {
    std::int32_t nearer = 0;  ///< those at lower ranges, 0.1 mm
    bool all = false;
  };

  BeamOptions options_;
  SweepImager imager_;
  BeamQuality quality_;
  std::optional<ByteBudget> budget_;
  std::optional<std::uint32_t> sent_model_;  ///< id of the model that the decoder has
  int frames_since_model_ = 0;
  ExtrasChoice extras_;
  int frames_to_review_ = 0;  ///< `extras_`
  PointCloud placed_;
  LayerPlan plan_;
  std::vector<std::int32_t> first_column_;              ///< as `find_first_columns` gives it
  std::vector<std::int32_t> range_, azimuth_, height_;  ///< the image, columns aligned by azimuth
  std::vector<std::pair<std::size_t, std::int32_t>> missed_;  ///< cells of the image, and ranges
  FiringCoder firing_coder_;
  LayerCoder layers_;
  OctreeCoder octree_;
  std::vector<LatticePoint> lattice_;        ///< points without a cell
  std::vector<std::uint32_t> extra_points_;  ///< of `lattice_`, indices into the cloud
  AttributeEncoder attributes_;
  StageClock* stages_;
  StageLap lap_{nullptr};
};

/// Makes clouds of frames; keeps the sensor models that it has seen.
class Decoder {
 public:
  explicit Decoder(StageClock* stages = nullptr) : stages_(stages) {}

  /// Fills `cloud` from a frame whose head is parsed, from its first `layers` layers. `fill`: what
  /// was left out is appended as interpolation has it, and marked.
  /// Errors: truncated, corrupt, limit, unsupported (the frame's model came with an earlier frame
  /// that this decoder has not seen).
  [[nodiscard]] Status decode(std::span<const std::byte> frame, const FrameHeader& header,
                              int layers, bool fill, PointCloud& cloud);

 private:
  [[nodiscard]] Status read_model_part(std::span<const std::byte> frame, const FrameHeader& header);
  [[nodiscard]] bool read_grid(std::span<const std::byte> bytes, std::size_t most_cells);
  [[nodiscard]] Status read_layers(std::span<const std::byte> frame, const FrameHeader& header,
                                   int layers);
  [[nodiscard]] Status read_extras(std::span<const std::byte> frame, const FrameHeader& header);
  [[nodiscard]] Status read_exact_part(std::span<const std::byte> frame, const FrameHeader& header);
  [[nodiscard]] Status read_slots(std::span<const std::byte> frame, const FrameHeader& header);
  void assemble(PointCloud& cloud);
  void append_filled(PointCloud& cloud);

  SensorModel model_;
  std::optional<std::uint32_t> model_id_;
  std::optional<BeamUnprojector> unprojector_;
  bool complete_ = false;     ///< whether all layers of the frame at hand are decoded
  bool known_model_ = false;  ///< whether the frame at hand refers to `model_`
  BeamImage image_;
  LayerPlan plan_;
  std::vector<std::int32_t> first_column_;  ///< as `find_first_columns` gives it
  std::vector<std::int32_t> range_;         ///< columns aligned by azimuth
  std::vector<CellState> state_;
  std::vector<std::int32_t> azimuth_, height_;  ///< residuals, columns aligned by azimuth
  FiringCoder firing_coder_;
  LayerCoder layers_;
  OctreeCoder octree_;
  double extras_step_m_ = 0;
  std::vector<LatticePoint> lattice_;  ///< the extras
  PointCloud placed_;                  ///< points of the image, row by row, then the extras
  AttributeDecoder attributes_;
  PointOrder order_;                      ///< empty where points come firing by firing
  std::vector<std::uint32_t> next_slot_;  ///< of each firing
  std::vector<std::uint32_t> slots_;      ///< places of `placed_` in the cloud
  StageClock* stages_;
  StageLap lap_{nullptr};
};

}  // namespace sweepcast::beam
