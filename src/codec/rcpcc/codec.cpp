#include "codec/rcpcc/codec.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "codec/rcpcc/occupancy.hpp"

namespace sweepcast::rcpcc {
namespace {

// What a frame may say at most; the ranges of the options below stay within.
constexpr std::size_t kMostCells = std::size_t{1} << 24;
constexpr int kLargestStep = 10'000'000;                  // millionths of a degree
constexpr int kMostRows = 3'601;                          // of 0.05 degrees
constexpr int kLargestThreshold = 10'000;                 // millimetres
constexpr std::size_t kLargestGrid = 64 + 2 * kMostRows;  // bytes

std::int32_t millimetres(double metres) {
  return static_cast<std::int32_t>(std::lround(metres * 1000.0));
}

// Rejects NaN too.
Status within(std::string_view option, double value, double low, double high,
              std::string_view unit) {
  if (value >= low && value <= high) return {};
  const auto number = [](double v) {
    std::string text = std::to_string(v);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
  };
  return fail(ErrorCode::invalid_argument, std::string(option) + " is " + number(value) +
                                               "; it must lie between " + number(low) + " and " +
                                               number(high) + std::string(unit));
}

Status one_of(std::string_view option, int value, std::span<const int> choices) {
  std::string list;
  for (const int choice : choices) {
    if (value == choice) return {};
    list += (list.empty() ? "" : ", ") + std::to_string(choice);
  }
  return fail(ErrorCode::invalid_argument,
              std::string(option) + " is " + std::to_string(value) + "; it must be one of " + list);
}

constexpr std::array kBlockSizes = {4, 8, 16};
constexpr std::array kRegionSizes = {4, 8, 16, 32};

void write_grid(const RangeImage& image, const SurfaceOptions& surface, const UnfitOptions& unfit,
                ByteWriter& out) {
  const SphericalGrid& grid = image.grid;
  out.put_signed(grid.azimuth_min);
  out.put_varint(static_cast<std::uint64_t>(grid.azimuth_step));
  out.put_signed(grid.elevation_min);
  out.put_varint(static_cast<std::uint64_t>(grid.elevation_step));
  out.put_varint(static_cast<std::uint64_t>(grid.rows));
  out.put_varint(static_cast<std::uint64_t>(grid.cols));
  out.put_varint(static_cast<std::uint64_t>(surface.model));
  out.put_varint(static_cast<std::uint64_t>(surface.block_size));
  out.put_varint(static_cast<std::uint64_t>(surface.threshold_mm));
  out.put_varint(static_cast<std::uint64_t>(unfit.coding));
  out.put_varint(static_cast<std::uint64_t>(unfit.region_size));
  out.put_varint(static_cast<std::uint64_t>(unfit.step_mm));
  for (const RowOffset& offset : image.offsets) out.put(offset.azimuth);
  for (const RowOffset& offset : image.offsets) out.put(offset.elevation);
}

}  // namespace

std::string_view part_name(std::uint8_t kind) noexcept {
  switch (static_cast<Part>(kind)) {
    case Part::grid:
      return "grid";
    case Part::occupancy:
      return "occupancy";
    case Part::surfaces:
      return "surfaces";
    case Part::unfit:
      return "unfit";
  }
  return "unknown";
}

Status check(const RcpccOptions& o) {
  for (const Status& status : {
           within("azimuth step", o.params.azimuth_step_deg, 0.05, 10, " degrees"),
           within("elevation step", o.params.elevation_step_deg, 0.05, 10, " degrees"),
           within("threshold", o.params.threshold_m, 0.001, 10, " m"),
           within("quantiser step", o.params.quantiser_step_m, 0.001, 10, " m"),
           within("lowest elevation", o.elevation_min_deg, -90, 90, " degrees"),
           within("highest elevation", o.elevation_max_deg, o.elevation_min_deg + 0.05, 90,
                  " degrees"),
           within("first azimuth", o.azimuth_min_deg, -180, 180, " degrees"),
           within("last azimuth", o.azimuth_max_deg, -180, 180, " degrees"),
           within("largest range", o.max_range_m, 0.1, 1000, " m"),
           within("zstd level", o.zstd_level, 1, 22, ""),
           one_of("block size", o.block_size, kBlockSizes),
           one_of("region size", o.region_size, kRegionSizes),
       }) {
    if (!status) return status;
  }
  return {};
}

Encoder::Encoder(const RcpccOptions& options, const Crop& crop, StageClock* stages)
    : surface_options_{options.block_size, millimetres(options.params.threshold_m), options.model},
      unfit_options_{options.region_size, millimetres(options.params.quantiser_step_m),
                     options.unfit, options.rounding},
      projector_(options, crop),
      zstd_(options.zstd_level),
      stages_(stages) {}

// One sweep's way: range image, surfaces, what they leave, bytes.
Status Encoder::encode(const CloudView& cloud, PartList& parts, SweepCounts& counts) {
  lap_ = StageLap(stages_);
  projector_.project(cloud, image_, counts);
  lap_.end("projection");
  if (image_.grid.cells() > kMostCells) {
    return fail(ErrorCode::limit, "the range image would have over 2^24 cells; take larger steps");
  }
  parts.clear();
  pack(Part::grid, "occupancy", parts,
       [&](ByteWriter& out) { write_grid(image_, surface_options_, unfit_options_, out); });
  pack(Part::occupancy, "occupancy", parts,
       [&](ByteWriter& out) { write_occupancy(image_.range_mm, out); });

  list_occupied_blocks(image_, surface_options_.block_size, blocks_);
  fitter_.fit(image_, blocks_, surface_options_, surfaces_);
  if (!paint_surfaces(surfaces_, blocks_, surface_options_, image_, fitted_)) {
    return fail(ErrorCode::invalid_argument, "internal: a surface without a range was fitted");
  }
  pack(Part::surfaces, "surface fitting", parts,
       [&](ByteWriter& out) { write_surfaces(surfaces_, out); });
  pack(Part::unfit, "SA-DCT", parts,
       [&](ByteWriter& out) { unfit_coder_.write(image_, fitted_, unfit_options_, out); });
  return {};
}

template <class Write>
void Encoder::pack(Part part, std::string_view stage, PartList& parts, Write write) {
  raw_.clear();
  ByteWriter out(raw_);
  write(out);
  lap_.end(stage);
  parts.begin(static_cast<std::uint8_t>(part));
  zstd_.append(raw_, parts.bytes());
  lap_.end("zstd");
}

// The same way back.
Status Decoder::decode(std::span<const std::byte> frame, const FrameHeader& header,
                       PointCloud& cloud) {
  const auto damaged = [](std::string_view what) {
    return fail(ErrorCode::corrupt, "the frame's " + std::string(what) + " cannot be right");
  };
  lap_ = StageLap(stages_);
  if (Status status = unpack(frame, header, Part::grid); !status) return status;
  if (!read_grid()) return damaged("grid");

  if (Status status = unpack(frame, header, Part::occupancy); !status) return status;
  ByteReader occupancy(raw_);
  if (!read_occupancy(occupancy, image_.range_mm)) return damaged("occupancy");
  if (std::count(image_.range_mm.begin(), image_.range_mm.end(), 1) !=
      static_cast<std::ptrdiff_t>(header.counts.points_coded)) {
    return damaged("number of points");
  }
  lap_.end("occupancy");

  if (Status status = unpack(frame, header, Part::surfaces); !status) return status;
  ByteReader surfaces(raw_);
  list_occupied_blocks(image_, surface_options_.block_size, blocks_);
  if (!read_surfaces(surfaces, blocks_, surfaces_) ||
      !paint_surfaces(surfaces_, blocks_, surface_options_, image_, fitted_)) {
    return damaged("list of surfaces");
  }
  lap_.end("surfaces");

  if (Status status = unpack(frame, header, Part::unfit); !status) return status;
  ByteReader unfit(raw_);
  if (!unfit_coder_.read(unfit, fitted_, unfit_options_, image_)) return damaged("unfit image");
  lap_.end("inverse SA-DCT");

  unprojector_.unproject(image_, cloud);
  lap_.end("projection back");
  return {};
}

Status Decoder::unpack(std::span<const std::byte> frame, const FrameHeader& header, Part part) {
  const auto packed = checked_part(frame, header, static_cast<std::uint8_t>(part));
  if (!packed) return tl::unexpected(packed.error());
  // No part has more than an escaped symbol (6 bytes) a cell, beside a few numbers.
  const std::size_t largest = part == Part::grid ? kLargestGrid : 64 + 8 * image_.grid.cells();
  Status status = zstd_.decode(*packed, largest, raw_);
  lap_.end("zstd");
  return status;
}

bool Decoder::read_grid() {
  ByteReader in(raw_);
  SphericalGrid& grid = image_.grid;
  const auto number = [&](int cap) {
    return static_cast<int>(in.get_varint(static_cast<std::uint64_t>(cap)));
  };
  grid.azimuth_min = static_cast<std::int32_t>(in.get_signed());
  grid.azimuth_step = number(kLargestStep);
  grid.elevation_min = static_cast<std::int32_t>(in.get_signed());
  grid.elevation_step = number(kLargestStep);
  grid.rows = number(kMostRows);
  grid.cols = number(kMostRows * 2);
  surface_options_.model = static_cast<SurfaceModel>(number(1));
  surface_options_.block_size = number(kBlockSizes.back());
  surface_options_.threshold_mm = number(kLargestThreshold);
  unfit_options_.coding = static_cast<UnfitCoding>(number(1));
  unfit_options_.region_size = number(kRegionSizes.back());
  unfit_options_.step_mm = number(kLargestThreshold);
  if (!in.ok() || grid.azimuth_step == 0 || grid.elevation_step == 0 || grid.cols == 0 ||
      grid.cells() > kMostCells || surface_options_.threshold_mm == 0 ||
      unfit_options_.step_mm == 0 || !one_of("", surface_options_.block_size, kBlockSizes) ||
      !one_of("", unfit_options_.region_size, kRegionSizes)) {
    return false;
  }
  image_.offsets.resize(static_cast<std::size_t>(grid.rows));
  for (RowOffset& offset : image_.offsets) offset.azimuth = in.get<std::int8_t>();
  for (RowOffset& offset : image_.offsets) offset.elevation = in.get<std::int8_t>();
  image_.range_mm.resize(grid.cells());
  return in.ok();
}

}  // namespace sweepcast::rcpcc
