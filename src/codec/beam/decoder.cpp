#include <algorithm>
#include <bit>
#include <limits>
#include <string>

#include "codec/beam/alignment.hpp"
#include "codec/beam/codec.hpp"
#include "codec/beam/model_bytes.hpp"
#include "core/crc32.hpp"

namespace sweepcast::beam {
namespace {

constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 24;
constexpr std::int32_t kLargestStep = 1 << 20;

/// Whether a frame may begin with every so many rows or columns.
bool is_stride(int stride) {
  return stride > 0 && stride <= 16 && std::has_single_bit(static_cast<unsigned>(stride));
}

/// Every layer halves the distance of the columns.
int layers_of(int base_cols) {
  return std::countr_zero(static_cast<unsigned>(base_cols)) + 1;
}

}  // namespace

std::string_view part_name(std::uint8_t kind) noexcept {
  if (kind >= static_cast<std::uint8_t>(Part::layer_attributes)) return "layer attributes";
  if (kind >= static_cast<std::uint8_t>(Part::layer)) return "layer";
  switch (static_cast<Part>(kind)) {
    case Part::model:
      return "model";
    case Part::grid:
      return "grid";
    case Part::firings:
      return "firings";
    case Part::extras:
      return "extras";
    case Part::attributes:
    case Part::extra_attributes:
      return "attributes";
    case Part::exact:
      return "exact";
    case Part::order:
      return "order";
    case Part::layer:
    case Part::layer_attributes:
      break;
  }
  return "unknown";
}

std::optional<int> layers_of_grid(std::span<const std::byte> grid) {
  ByteReader in(grid);
  if (in.get_varint(kMaxTicks) == 0) return in.ok() ? std::optional(1) : std::nullopt;
  (void)in.get<std::uint32_t>();  // the model's id
  (void)in.get<std::uint8_t>();   // effort
  (void)in.get<std::uint8_t>();   // rows
  const int base_cols = in.get<std::uint8_t>();
  if (!in.ok() || !is_stride(base_cols)) return std::nullopt;
  return layers_of(base_cols);
}

// The same way back.
Status Decoder::decode(std::span<const std::byte> frame, const FrameHeader& header, int layers,
                       bool fill, PointCloud& cloud) {
  lap_ = StageLap(stages_);
  if (Status status = read_model_part(frame, header); !status) return status;
  const auto grid = checked_part(frame, header, static_cast<std::uint8_t>(Part::grid));
  if (!grid) return tl::unexpected(grid.error());
  if (!read_grid(*grid, most_cells(header.counts.points_in)))
    return fail(ErrorCode::corrupt, "the frame's grid cannot be right");
  lap_.end("sensor model");
  if (Status status = read_extras(frame, header); !status) return status;
  lap_.end("points without a cell");
  complete_ = true;
  if (image_.cols > 0) {
    if (Status status = read_layers(frame, header, layers); !status) return status;
    unprojector_->unproject(image_, placed_);
    lap_.end("projection back");
  } else if (Status status = attributes_.begin(frame, header, nullptr, {}, lattice_.size());
             !status) {
    return status;
  } else {
    placed_.clear();
  }
  append_places(lattice_, extras_step_m_, placed_);
  if (placed_.size() > header.counts.points_coded) {
    return fail(ErrorCode::corrupt, "the frame holds more points than its head announces");
  }
  if (Status status = read_exact_part(frame, header); !status) return status;
  if (Status status = read_slots(frame, header); !status) return status;
  lap_.end("exact coordinates, order");
  assemble(cloud);
  lap_.end("points to their places");
  if (fill && image_.cols > 0) append_filled(cloud);
  lap_.end("filling");
  return {};
}

// Appends the points that were left out, as interpolation has them.
void Decoder::append_filled(PointCloud& cloud) {
  for_each_aligned(first_column_, image_, [&](std::size_t cell, std::size_t aligned) {
    image_.range[cell] = state_[aligned] == CellState::filled ? range_[aligned] : 0;
  });
  unprojector_->unproject(image_, placed_);
  cloud.filled.assign(cloud.size(), 0);
  cloud.x.insert(cloud.x.end(), placed_.x.begin(), placed_.x.end());
  cloud.y.insert(cloud.y.end(), placed_.y.begin(), placed_.y.end());
  cloud.z.insert(cloud.z.end(), placed_.z.begin(), placed_.z.end());
  cloud.filled.resize(cloud.size(), 1);
  if (cloud.has_intensity()) cloud.intensity.resize(cloud.size());
  if (cloud.has_ring()) cloud.ring.resize(cloud.size());
  if (cloud.has_time()) cloud.time_ns.resize(cloud.size());
  if (!placed_.empty()) cloud.width = 0;
}

// A coarser sweep, or one whose exact part is cut off, stays as near as its bound says.
Status Decoder::read_exact_part(std::span<const std::byte> frame, const FrameHeader& header) {
  if (!complete_ || !has_part(header, static_cast<std::uint8_t>(Part::exact))) return {};
  const auto bytes = checked_part(frame, header, static_cast<std::uint8_t>(Part::exact));
  if (!bytes && bytes.error().code == ErrorCode::truncated) return {};
  if (!bytes) return tl::unexpected(bytes.error());
  const PointOrigins origins = origins_of(&model_, image_, lattice_.size());
  if (read_exact(*bytes, origins, placed_)) return {};
  return fail(ErrorCode::corrupt, "the frame's exact coordinates end too early");
}

// Where the points go. A coarser sweep, or one whose order is cut off, comes firing by firing.
Status Decoder::read_slots(std::span<const std::byte> frame, const FrameHeader& header) {
  slots_.clear();
  order_.items.clear();
  order_.width = 0;
  if (complete_ && has_part(header, static_cast<std::uint8_t>(Part::order))) {
    const auto bytes = checked_part(frame, header, static_cast<std::uint8_t>(Part::order));
    if (!bytes && bytes.error().code != ErrorCode::truncated) return tl::unexpected(bytes.error());
    if (bytes) {
      if (!read_order(*bytes, image_, lattice_.size(), header.counts.points_in, order_)) {
        return fail(ErrorCode::corrupt, "the order of the frame's points cannot be right");
      }
      slots_of(order_, image_, lattice_.size(), slots_);
      return {};
    }
  }
  firing_order(image_, next_slot_, slots_);
  for (std::size_t i = 0; i < lattice_.size(); ++i) {
    slots_.push_back(static_cast<std::uint32_t>(slots_.size()));
  }
  return {};
}

// Puts all points where they belong, with their attributes.
void Decoder::assemble(PointCloud& cloud) {
  // Coordinates are all overwritten, so those of the last sweep stay: no time is lost on zeros.
  cloud.intensity.clear();
  cloud.ring.clear();
  cloud.time_ns.clear();
  cloud.filled.clear();
  cloud.width = order_.width;
  cloud.resize_xyz(std::max(slots_.size(), order_.items.size()));
  if (cloud.size() > slots_.size()) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    for (auto* column : {&cloud.x, &cloud.y, &cloud.z}) {
      std::fill(column->begin(), column->end(), kNan);
    }
  }
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    cloud.x[slots_[i]] = placed_.x[i];
    cloud.y[slots_[i]] = placed_.y[i];
    cloud.z[slots_[i]] = placed_.z[i];
  }
  attributes_.restore(image_, slots_, cloud);
}

Status Decoder::read_model_part(std::span<const std::byte> frame, const FrameHeader& header) {
  if (!has_part(header, static_cast<std::uint8_t>(Part::model))) return {};
  const auto bytes = checked_part(frame, header, static_cast<std::uint8_t>(Part::model));
  if (!bytes) return tl::unexpected(bytes.error());
  const std::uint32_t id = crc32(*bytes);
  if (model_id_ == id) return {};
  ByteReader in(*bytes);
  model_id_.reset();
  if (!read_model(in, model_)) {
    return fail(ErrorCode::corrupt, "the frame's sensor model cannot be right");
  }
  unprojector_.emplace(model_);
  model_id_ = id;
  return {};
}

bool Decoder::read_grid(std::span<const std::byte> bytes, std::size_t most) {
  ByteReader in(bytes);
  image_.cols = static_cast<int>(in.get_varint(kMaxTicks));
  if (image_.cols == 0) return in.ok();
  const auto id = in.get<std::uint32_t>();
  const bool is_coding = set_coding(in.get<std::uint8_t>(), plan_);
  const int base_rows = in.get<std::uint8_t>();
  const int base_cols = in.get<std::uint8_t>();
  if (!is_stride(base_rows) || !is_stride(base_cols) || !is_coding) return false;
  plan_.quality.resize(static_cast<std::size_t>(layers_of(base_cols)));
  for (LayerQuality& quality : plan_.quality) {
    quality.step = static_cast<std::int32_t>(in.get_varint(kLargestStep));
    quality.tolerance =
        static_cast<std::int32_t>(std::clamp<std::int64_t>(in.get_signed(), -1, kLargestStep));
    if (quality.step == 0) return false;
  }
  known_model_ = model_id_ == id;
  image_.azimuth_divisor = static_cast<std::int32_t>(in.get_varint(kMaxTicks));
  image_.height_step = static_cast<std::int32_t>(in.get_varint(kLargestStep));
  image_.motion.reset();
  if (in.get<std::uint8_t>() != 0) image_.motion = read_motion(in);
  if (!in.ok()) return false;
  if (!known_model_) return true;
  image_.rows = static_cast<int>(model_.beams.size());
  if (image_.cells() > most || image_.cols > model_.ticks_per_turn) return false;
  if (image_.motion && !sweepcast::check(*image_.motion, model_)) return false;
  set_plan(model_, image_.cols, base_rows, base_cols, plan_);
  return true;
}

Status Decoder::read_layers(std::span<const std::byte> frame, const FrameHeader& header,
                            int layers) {
  if (!known_model_) {
    return fail(ErrorCode::unsupported,
                "the frame's sensor model came with an earlier frame; decode from there");
  }
  const auto firings = checked_part(frame, header, static_cast<std::uint8_t>(Part::firings));
  if (!firings) return tl::unexpected(firings.error());
  image_.firing_tick.resize(static_cast<std::size_t>(image_.cols));
  image_.held.resize(has_interpolated_lags(model_) ? image_.firing_tick.size() : 0);
  if (!firing_coder_.read(*firings, model_.ticks_per_turn, image_.firing_tick, image_.held)) {
    return fail(ErrorCode::corrupt, "the frame's firings cannot be right");
  }
  find_first_columns(model_, image_, first_column_);
  const bool residuals = image_.azimuth_divisor != 0;
  for (auto* plane : {&azimuth_, &height_}) plane->assign(residuals ? image_.cells() : 0, 0);
  if (Status status = attributes_.begin(frame, header, &plan_, first_column_, lattice_.size());
      !status) {
    return status;
  }
  lap_.end("firings");
  layers_.begin(plan_);
  layers = std::clamp(layers, 1, LayerCoder::layers(plan_));
  complete_ = layers == LayerCoder::layers(plan_);
  for (int layer = 0; layer < layers; ++layer) {
    const auto bytes = checked_part(
        frame, header, static_cast<std::uint8_t>(static_cast<int>(Part::layer) + layer));
    const bool is_absent =
        !has_part(header, static_cast<std::uint8_t>(static_cast<int>(Part::layer) + layer));
    if (!bytes && layer > 0 && (is_absent || bytes.error().code == ErrorCode::truncated)) {
      complete_ = false;
      break;
    }
    if (!bytes) return tl::unexpected(bytes.error());
    // A layer whose attributes are cut off is left out whole.
    Status attributes = attributes_.check_layer(frame, header, layer);
    if (!attributes && attributes.error().code == ErrorCode::truncated && layer > 0) {
      complete_ = false;
      break;
    }
    if (!attributes) return attributes;
    if (!layers_.decode(layer, *bytes, {azimuth_, height_})) {
      return fail(ErrorCode::corrupt, "a layer of the frame ends too early");
    }
    lap_.end("ranges");
    if (Status status = attributes_.read_layer(frame, header, layer, layers_); !status) {
      return status;
    }
    lap_.end("attributes");
  }

  layers_.read(range_, state_);
  image_.range.resize(image_.cells());
  image_.azimuth_residual.resize(azimuth_.size());
  image_.height_residual.resize(height_.size());
  for_each_aligned(first_column_, image_, [&](std::size_t cell, std::size_t aligned) {
    image_.range[cell] = state_[aligned] == CellState::measured ? range_[aligned] : 0;
    if (!residuals) return;
    image_.azimuth_residual[cell] = azimuth_[aligned];
    image_.height_residual[cell] = height_[aligned];
  });
  return {};
}

Status Decoder::read_extras(std::span<const std::byte> frame, const FrameHeader& header) {
  lattice_.clear();
  if (!has_part(header, static_cast<std::uint8_t>(Part::extras))) return {};
  const auto bytes = checked_part(frame, header, static_cast<std::uint8_t>(Part::extras));
  if (!bytes) return tl::unexpected(bytes.error());
  ByteReader in(*bytes);
  const std::uint64_t count =
      in.get_varint(std::min<std::uint64_t>(header.counts.points_coded, kMostPoints));
  extras_step_m_ = static_cast<double>(in.get_varint(kLargestStep)) / kRangeUnits;
  if (in.ok()) {
    lattice_.resize(count);
    if (octree_.read(in.get_bytes(in.remaining()), lattice_)) return {};
  }
  return fail(ErrorCode::corrupt, "the frame's extra points cannot be right");
}

}  // namespace sweepcast::beam
