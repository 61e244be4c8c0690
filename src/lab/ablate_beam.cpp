#include "lab/ablate_beam.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "codec/beam/alignment.hpp"
#include "codec/beam/codec.hpp"
#include "codec/beam/error_bound.hpp"
#include "codec/beam/model_bytes.hpp"
#include "codec/beam/place_choice.hpp"
#include "sensor/beam_grid.hpp"
#include "sweepcast/cloud_file.hpp"
#include "sweepcast/sensor_model.hpp"

namespace sweepcast::lab {
namespace {

using beam::LatticePoint;
using beam::LayerCoder;
using beam::LayerPlan;
using beam::Part;

/// What a sweep becomes, as far as a stage changes it.
struct Pieces {
  std::size_t layers = 0, firings = 0, extras = 0;  ///< bytes

  [[nodiscard]] std::size_t total() const { return layers + firings + extras; }
};

/// A frame's own.
Pieces pieces_of(const FrameHeader& frame) {
  Pieces pieces;
  for (const FramePart& part : frame.parts) {
    if (part.kind == static_cast<std::uint8_t>(Part::firings)) pieces.firings = part.size;
    if (part.kind == static_cast<std::uint8_t>(Part::extras)) pieces.extras = part.size;
    const int layer = part.kind - static_cast<int>(Part::layer);
    if (layer >= 0 && layer < 16) pieces.layers += part.size;
  }
  return pieces;
}

/// Bytes of points as an octree whose cells keep the bound.
std::size_t octree_bytes(const PointCloud& cloud, const std::vector<std::uint32_t>& points,
                         double max_error_m) {
  const double step_m = static_cast<double>(beam::extras_step(max_error_m)) / kRangeUnits;
  PointCloud inside;
  for (const std::uint32_t point : points) {
    LatticePoint place{};
    if (!beam::nearest_place({cloud.x[point], cloud.y[point], cloud.z[point]}, step_m, place)) {
      continue;
    }
    inside.x.push_back(cloud.x[point]);
    inside.y.push_back(cloud.y[point]);
    inside.z.push_back(cloud.z[point]);
  }
  std::vector<LatticePoint> lattice;
  beam::choose_places(inside.x, inside.y, inside.z, step_m, max_error_m, lattice);
  if (lattice.empty()) return 0;
  std::vector<std::uint32_t> order(lattice.size());
  beam::OctreeCoder octree;
  octree.sort(lattice, order);
  std::vector<std::byte> bytes;
  octree.write(lattice, bytes);
  constexpr std::size_t kHead = 5;  // how many, and the step
  return bytes.size() + kHead;
}

/// The model without what a plain spherical grid does not know: all beams come from one origin and
/// look the same way at the same time.
SensorModel spherical(SensorModel model) {
  for (Beam& beam : model.beams) {
    beam.height = 0;
    beam.azimuth_offset = 0;
    beam.lateral_offset = 0;
    beam.lag = 0;
    beam.interpolated = 0;
  }
  return model;
}

/// One sweep as codec beam sees it through one sensor model.
class Scene {
 public:
  Scene(const SensorModel& model, double max_error_m)
      : model_(model), max_error_m_(max_error_m), projector_(model) {}

  void project(const PointCloud& cloud, const std::optional<Motion>& motion) {
    BeamGridOptions grid;
    grid.max_error_m = beam::kAngularShare * max_error_m_;
    grid.nearest = beam::kNearest;
    grid.farthest = beam::kFarthest;
    grid.motion = motion;
    projector_.project(cloud.x, cloud.y, cloud.z, grid, image_);
    const bool residuals = !image_.azimuth_residual.empty();
    range_.resize(image_.cells());
    azimuth_.resize(residuals ? image_.cells() : 0);
    height_.resize(residuals ? image_.cells() : 0);
    std::vector<std::int32_t> first;
    beam::find_first_columns(model_, image_, first);
    beam::for_each_aligned(first, image_, [&](std::size_t from, std::size_t to) {
      range_[to] = image_.range[from];
      if (!residuals) return;
      azimuth_[to] = image_.azimuth_residual[from];
      height_[to] = image_.height_residual[from];
    });
  }

  [[nodiscard]] LayerPlan plan(int base_rows, int base_cols, Effort effort) const {
    LayerPlan plan;
    beam::set_plan(model_, image_.cols, base_rows, base_cols, plan);
    plan.effort = effort;
    plan.quality.assign(static_cast<std::size_t>(LayerCoder::layers(plan)),
                        {beam::range_step(max_error_m_), -1});
    return plan;
  }

  [[nodiscard]] std::size_t layer_bytes(const LayerPlan& plan) {
    coder_.begin(plan);
    bytes_.clear();
    for (int layer = 0; layer < LayerCoder::layers(plan); ++layer) {
      coder_.encode(layer, {range_, azimuth_, height_}, bytes_);
    }
    return bytes_.size();
  }

  [[nodiscard]] Pieces code(const PointCloud& cloud, const LayerPlan& plan) {
    Pieces pieces;
    pieces.layers = layer_bytes(plan);
    bytes_.clear();
    beam::FiringCoder().write(image_.firing_tick, bytes_, image_.held);
    pieces.firings = bytes_.size();
    std::vector<std::uint32_t> extras;
    for (const ExtraPoint& extra : image_.extras) {
      if (extra.reason != ExtraReason::not_finite && extra.reason != ExtraReason::zero_range) {
        extras.push_back(extra.point);
      }
    }
    pieces.extras = octree_bytes(cloud, extras, max_error_m_);
    return pieces;
  }

 private:
  SensorModel model_;
  double max_error_m_;
  BeamProjector projector_;
  BeamImage image_;
  std::vector<std::int32_t> range_, azimuth_, height_;
  LayerCoder coder_;
  std::vector<std::byte> bytes_;
};

enum Row : std::size_t {
  whole,
  sphere,
  octree,
  prediction,
  raster_prediction,
  mixing,
  pyramid,
  edges,
  thinned,
  thinning,
  kRows
};

std::vector<StageRow> named_rows() {
  std::vector<StageRow> rows(kRows);
  rows[whole] = {"", "everything, within the bound"};
  rows[sphere] = {"grid", "spherical: the beams' elevations, one origin"};
  rows[octree] = {"grid", "octree"};
  rows[prediction] = {"prediction", "the nearest value before, coarse to fine"};
  rows[raster_prediction] = {"prediction, pyramid", "the value before, row by row"};
  rows[mixing] = {"mixing", "one context a decision (effort fast)"};
  rows[pyramid] = {"pyramid", "row by row, from the left and from above"};
  rows[edges] = {"edges", "no choice of a side"};
  rows[thinned] = {"", "everything, level 4"};
  rows[thinning] = {"thinning", "level 4's steps, every point"};
  return rows;
}

/// Measures sweep after sweep.
class StageMeter {
 public:
  static Result<StageMeter> create(const PointCloud& first, const StageAblationOptions& options) {
    EncoderOptions bound;
    bound.codec = CodecId::beam;
    bound.beam.max_error_m = options.max_error_m;
    bound.beam.effort = options.effort;
    bound.beam.fields = Fields::xyz;
    EncoderOptions level = bound;
    level.beam.level = kLevel;
    auto encoder = Encoder::create(bound);
    if (!encoder) return tl::unexpected(std::move(encoder.error()));
    auto thinner = Encoder::create(level);
    if (!thinner) return tl::unexpected(std::move(thinner.error()));
    const CloudView view(first);
    auto estimate = estimate_sensor_model(std::span(&view, 1));
    if (!estimate) return tl::unexpected(std::move(estimate.error()));
    return StageMeter(options, std::move(*estimate), std::move(*encoder), std::move(*thinner));
  }

  Status add(const PointCloud& cloud) {
    const auto frame = encoder_.encode(cloud, SweepInfo{});
    if (!frame) return tl::unexpected(frame.error());
    FrameHeader header;
    if (Status parsed = parse_frame_header(*frame, header); !parsed) return parsed;
    const Pieces own = pieces_of(header);
    const auto put = [&, size = frame->size()](Row row, const Pieces& pieces) {
      sums_[row] += static_cast<double>(size - own.total() + pieces.total());
    };

    if (motion_) motion_ = estimate_motion(cloud, model_, &*motion_);
    scene_.project(cloud, motion_);
    sphere_.project(cloud, motion_);
    const LayerPlan full = scene_.plan(kBaseRows, kBaseCols, options_.effort);
    const auto changed = [&](auto change) {
      LayerPlan plan = full;
      change(plan);
      return Pieces{scene_.layer_bytes(plan), own.firings, own.extras};
    };
    put(whole, own);
    put(sphere, sphere_.code(cloud, sphere_.plan(kBaseRows, kBaseCols, options_.effort)));
    put(octree, {0, 0, octree_bytes(cloud, finite_points(cloud), options_.max_error_m)});
    put(prediction, changed([](LayerPlan& plan) { plan.stages.prediction = false; }));
    put(mixing, changed([](LayerPlan& plan) { plan.effort = Effort::fast; }));
    put(edges, changed([](LayerPlan& plan) { plan.stages.edges = false; }));
    LayerPlan raster = scene_.plan(1, 1, options_.effort);
    put(pyramid, {scene_.layer_bytes(raster), own.firings, own.extras});
    raster.stages.prediction = false;
    put(raster_prediction, {scene_.layer_bytes(raster), own.firings, own.extras});
    ++sweeps_;
    return add_level(cloud, full);
  }

  [[nodiscard]] std::vector<StageRow> rows() const {
    std::vector<StageRow> rows = named_rows();
    double reference = 0.0;
    for (std::size_t i = 0; i < kRows; ++i) {
      rows[i].bytes = sums_[i] / static_cast<double>(sweeps_);
      if (rows[i].stage.empty()) reference = rows[i].bytes;
      rows[i].factor = rows[i].bytes / reference;
    }
    return rows;
  }

 private:
  static constexpr int kLevel = 4;
  static constexpr int kBaseRows = 4;   // as the encoder's
  static constexpr int kBaseCols = 16;  // as the encoder's

  StageMeter(const StageAblationOptions& options, SensorEstimate&& estimate, Encoder&& encoder,
             Encoder&& thinner)
      : options_(options),
        model_(std::move(estimate.model)),
        encoder_(std::move(encoder)),
        thinner_(std::move(thinner)),
        scene_(model_, options.max_error_m),
        sphere_(spherical(model_), options.max_error_m) {
    if (!estimate.motions.empty()) motion_ = estimate.motions.front();
  }

  static std::vector<std::uint32_t> finite_points(const PointCloud& cloud) {
    std::vector<std::uint32_t> points;
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
      const bool somewhere = cloud.x[i] != 0.0F || cloud.y[i] != 0.0F || cloud.z[i] != 0.0F;
      if (cloud.is_finite(i) && somewhere) points.push_back(i);
    }
    return points;
  }

  // What thinning saves: the layers' bytes at the level's steps, with and without tolerances.
  Status add_level(const PointCloud& cloud, LayerPlan plan) {
    const auto frame = thinner_.encode(cloud, SweepInfo{});
    if (!frame) return tl::unexpected(frame.error());
    const BeamQuality& quality = kBeamLevels.at(kLevel);
    for (std::size_t layer = 0; layer < plan.quality.size(); ++layer) {
      const std::size_t i = std::min(layer, BeamQuality::kLayers - 1);
      const double tolerance = quality.tolerance_m[i];
      plan.quality[layer] = {
          beam::range_step(quality.step_m[i] / 2.0),
          tolerance > 0 ? static_cast<std::int32_t>(tolerance * kRangeUnits) : -1};
    }
    const std::size_t thin = scene_.layer_bytes(plan);
    for (auto& layer : plan.quality) layer.tolerance = -1;
    const std::size_t every = scene_.layer_bytes(plan);
    sums_[thinned] += static_cast<double>(frame->size());
    sums_[thinning] += static_cast<double>(frame->size() + every) - static_cast<double>(thin);
    return {};
  }

  StageAblationOptions options_;
  SensorModel model_;
  std::optional<Motion> motion_;
  Encoder encoder_, thinner_;
  Scene scene_, sphere_;
  std::size_t sweeps_ = 0;
  std::array<double, kRows> sums_{};
};

}  // namespace

Result<std::vector<StageRow>> ablate_stages(std::span<const std::filesystem::path> sweeps,
                                            const StageAblationOptions& options) {
  if (sweeps.empty()) return fail(ErrorCode::invalid_argument, "ablate: no sweep to measure on");
  std::optional<StageMeter> meter;
  PointCloud cloud;
  for (const auto& path : sweeps) {
    if (Status read = read_cloud(path, cloud); !read) return tl::unexpected(read.error());
    if (!meter) {
      auto created = StageMeter::create(cloud, options);
      if (!created) {
        return fail(created.error().code, path.string() + ": " + created.error().message);
      }
      meter.emplace(std::move(*created));
    }
    if (const Status added = meter->add(cloud); !added) {
      return fail(added.error().code, path.string() + ": " + added.error().message);
    }
    if (options.on_sweep) options.on_sweep(path.filename().string());
  }
  return meter->rows();
}

}  // namespace sweepcast::lab
