#include "codec/rcpcc/surface.hpp"

#include <algorithm>
#include <cmath>

#include "codec/rcpcc/symbols.hpp"
#include "core/trig.hpp"

namespace sweepcast::rcpcc {
namespace {

// A run is refitted only while it is short: later refits change little and cost time.
constexpr std::size_t kRefitCells = 1024;
// A surface with fewer cells costs more bytes than its cells would in the unfit image.
constexpr std::size_t kFewestCells = 3;

// The three functions of a cell in which inverse range is linear:
//     r0^2 / r = r0 e + gu u + gv v.
// Surface model: 1, columns, rows. Plane model: the cell's direction along the axis of the run's
// origin and along its two tangents, scaled to columns and rows, which makes it exact for a plane.
struct Terms {
  double e, u, v;
};

// The origin of a run: the centre of its first block.
class Origin {
 public:
  Origin(const SphericalGrid& grid, const SurfaceOptions& options, const Block& block)
      : model_(options.model),
        row_(block.row * options.block_size + 0.5 * (options.block_size - 1)),
        col_(block.col * options.block_size + 0.5 * (options.block_size - 1)),
        azimuth_step_(grid.azimuth_step * 1e-6 * kDegree),
        elevation_step_(grid.elevation_step * 1e-6 * kDegree),
        lowest_(grid.elevation_min * 1e-6 * kDegree) {
    if (model_ == SurfaceModel::plane) axis_ = sin_cos(elevation_of(row_));
  }

  [[nodiscard]] Terms terms(int row, int col) const {
    const double u = col - col_;
    const double v = row - row_;
    if (model_ == SurfaceModel::surface) return {1.0, u, v};
    const SinCos azimuth = sin_cos(u * azimuth_step_);
    const SinCos elevation = sin_cos(elevation_of(row));
    return {
        axis_.cos * elevation.cos * azimuth.cos + axis_.sin * elevation.sin,
        elevation.cos * azimuth.sin / azimuth_step_,
        (axis_.cos * elevation.sin - axis_.sin * elevation.cos * azimuth.cos) / elevation_step_};
  }

 private:
  [[nodiscard]] double elevation_of(double row) const {
    return lowest_ + (row + 0.5) * elevation_step_;
  }

  SurfaceModel model_;
  double row_, col_;
  double azimuth_step_, elevation_step_, lowest_;
  SinCos axis_;
};

// The range that encoder and decoder alike reconstruct, millimetres; 0 where the surface has none.
std::int32_t reconstruct(const Coefficients& c, const SurfaceSteps& steps, const Terms& t) {
  const double r0 = c.range * steps.range;
  const double denominator = r0 * t.e + steps.slope * (c.slope_u * t.u + c.slope_v * t.v);
  if (!(r0 > 0.0 && r0 * r0 < kLargestRange * denominator)) return 0;
  return static_cast<std::int32_t>(r0 * r0 / denominator + 0.5);
}

// Sums for the least squares of inverse range, weighted so that errors count in range: with s the
// range over a reference, minimise the sum of (s^2 (e c0 + u c1 + v c2) - s)^2.
class Moments {
 public:
  explicit Moments(double reference_mm) : reference_(reference_mm) {}

  void add(const Terms& t, double range_mm) {
    const double s = range_mm / reference_;
    const double w = s * s * s * s;
    ee_ += w * t.e * t.e;
    eu_ += w * t.e * t.u;
    ev_ += w * t.e * t.v;
    uu_ += w * t.u * t.u;
    uv_ += w * t.u * t.v;
    vv_ += w * t.v * t.v;
    const double target = s * s * s;
    e_ += target * t.e;
    u_ += target * t.u;
    v_ += target * t.v;
  }

  // Cholesky's method. The ridge keeps cells in one column, row or line from making the system
  // singular: the slope that they do not determine comes out as zero.
  [[nodiscard]] Coefficients solve(const SurfaceSteps& steps) const {
    const double ridge = 1e-6 * (ee_ + uu_ + vv_);
    const double a = std::sqrt(ee_);
    const double b = eu_ / a;
    const double c = ev_ / a;
    const double d = std::sqrt(uu_ + ridge - b * b);
    const double f = (uv_ - b * c) / d;
    const double g = std::sqrt(std::max(vv_ + ridge - c * c - f * f, ridge));
    const double p = e_ / a;
    const double q = (u_ - b * p) / d;
    const double r = (v_ - c * p - f * q) / g;
    const double c2 = r / g;
    const double c1 = (q - f * c2) / d;
    const double c0 = (p - b * c1 - c * c2) / a;
    if (!(c0 > 1e-3)) return {};  // the range at the origin would be negative or absurd
    const std::int32_t range = quantise(reference_ / c0, steps.range);
    if (range > kLargestRange) return {};  // `read_surfaces` would refuse it
    const double to_mm = reference_ / (c0 * c0);
    return {range, quantise(c1 * to_mm, steps.slope), quantise(c2 * to_mm, steps.slope)};
  }

 private:
  static std::int32_t quantise(double value, double step) {
    return static_cast<std::int32_t>(std::floor(std::clamp(value / step, -1e8, 1e8) + 0.5));
  }

  double reference_;
  double ee_ = 0, eu_ = 0, ev_ = 0, uu_ = 0, uv_ = 0, vv_ = 0, e_ = 0, u_ = 0, v_ = 0;
};

bool all_within(std::span<const OccupiedCell> cells, const Origin& origin, const Coefficients& c,
                const SurfaceSteps& steps, std::int32_t threshold_mm) {
  return std::all_of(cells.begin(), cells.end(), [&](const OccupiedCell& cell) {
    const std::int32_t range = reconstruct(c, steps, origin.terms(cell.row, cell.col));
    return range != 0 && std::abs(range - cell.range_mm) <= threshold_mm;
  });
}

// Calls visit(row, col) for the cells of a block; at the image's edges it has fewer.
template <class Visit>
void for_each_cell(const SphericalGrid& grid, int block_size, const Block& block, Visit visit) {
  const int row_end = std::min((block.row + 1) * block_size, grid.rows);
  const int col_end = std::min((block.col + 1) * block_size, grid.cols);
  for (int row = block.row * block_size; row < row_end; ++row) {
    for (int col = block.col * block_size; col < col_end; ++col) visit(row, col);
  }
}

void list_occupied_cells(const RangeImage& image, int block_size, const Block& block,
                         std::vector<OccupiedCell>& cells) {
  cells.clear();
  for_each_cell(image.grid, block_size, block, [&](int row, int col) {
    const std::int32_t range = image.row(row)[col];
    if (range != 0) cells.push_back({row, col, range});
  });
}

int blocks_in(int cells, int block_size) {
  return (cells + block_size - 1) / block_size;
}

}  // namespace

void list_occupied_blocks(const RangeImage& image, int block_size, std::vector<Block>& blocks) {
  blocks.clear();
  const int rows = blocks_in(image.grid.rows, block_size);
  const int cols = blocks_in(image.grid.cols, block_size);
  for (Block block; block.row < rows; ++block.row) {
    for (block.col = 0; block.col < cols; ++block.col) {
      std::int32_t any = 0;
      for_each_cell(image.grid, block_size, block,
                    [&](int row, int col) { any |= image.row(row)[col]; });
      if (any != 0) blocks.push_back(block);
    }
  }
}

SurfaceSteps SurfaceSteps::of(std::int32_t threshold_mm, int block_size) {
  return {std::max(1.0, threshold_mm / 4.0), std::max(0.25, threshold_mm / (2.0 * block_size))};
}

void SurfaceFitter::fit(const RangeImage& image, std::span<const Block> blocks,
                        const SurfaceOptions& options, std::vector<Surface>& surfaces) {
  surfaces.clear();
  const SurfaceSteps steps = SurfaceSteps::of(options.threshold_mm, options.block_size);
  bool running = false;  // whether the last surface may still grow
  Origin origin(image.grid, options, {});
  Moments moments(1.0);
  // A block joins a run only well within the threshold: merging at the whole threshold saves
  // another 4 % of the bytes, at the price of 3 to 13 points of F-score at 5 cm.
  const std::int32_t joining_mm = options.threshold_mm / 2;
  const auto add_block = [&] {
    for (const OccupiedCell& cell : block_) {
      moments.add(origin.terms(cell.row, cell.col), cell.range_mm);
    }
    run_.insert(run_.end(), block_.begin(), block_.end());
  };
  // The block joins the run if the run's parameters hold for it, or parameters fitted to both do.
  const auto extend = [&](Surface& surface) {
    const bool within = all_within(block_, origin, surface.coefficients, steps, joining_mm);
    if (run_.size() < kRefitCells) {
      add_block();
      if (!within) {
        const Coefficients refitted = moments.solve(steps);
        if (!all_within(run_, origin, refitted, steps, joining_mm)) return false;
        surface.coefficients = refitted;
      }
    } else if (!within) {
      return false;
    }
    ++surface.length;
    return true;
  };
  const auto end_run = [&] {
    if (running && surfaces.back().length == 1 && first_cells_ < kFewestCells) surfaces.pop_back();
    running = false;
  };

  for (std::uint32_t i = 0; i < blocks.size(); ++i) {
    if (i > 0 && blocks[i].row != blocks[i - 1].row) end_run();
    list_occupied_cells(image, options.block_size, blocks[i], block_);
    if (running && extend(surfaces.back())) continue;
    end_run();
    origin = Origin(image.grid, options, blocks[i]);
    moments = Moments(block_.front().range_mm);
    run_.clear();
    add_block();
    const Coefficients coefficients = moments.solve(steps);
    if (!all_within(block_, origin, coefficients, steps, options.threshold_mm)) continue;
    surfaces.push_back({i, 1, coefficients});
    first_cells_ = block_.size();
    running = true;
  }
  end_run();
}

bool paint_surfaces(std::span<const Surface> surfaces, std::span<const Block> blocks,
                    const SurfaceOptions& options, RangeImage& image,
                    std::vector<std::uint8_t>& fitted) {
  fitted.assign(image.grid.cells(), 0);
  const SurfaceSteps steps = SurfaceSteps::of(options.threshold_mm, options.block_size);
  bool sound = true;
  for (const Surface& surface : surfaces) {
    const Origin origin(image.grid, options, blocks[surface.first]);
    for (const Block& block : blocks.subspan(surface.first, surface.length)) {
      for_each_cell(image.grid, options.block_size, block, [&](int row, int col) {
        std::int32_t& range = image.row(row)[col];
        if (range == 0) return;
        range = reconstruct(surface.coefficients, steps, origin.terms(row, col));
        sound = sound && range != 0;
        fitted[static_cast<std::size_t>(&range - image.range_mm.data())] = 1;
      });
    }
  }
  return sound;
}

void write_surfaces(std::span<const Surface> surfaces, ByteWriter& out) {
  out.put_varint(surfaces.size());
  std::uint32_t end = 0;
  for (const Surface& surface : surfaces) {
    put_count(out, surface.first - end);
    end = surface.first + surface.length;
  }
  for (const Surface& surface : surfaces) put_count(out, surface.length - 1);
  std::int32_t range = 0;
  for (const Surface& surface : surfaces) {
    put_value(out, surface.coefficients.range - range);
    range = surface.coefficients.range;
  }
  for (const Surface& surface : surfaces) put_value(out, surface.coefficients.slope_u);
  for (const Surface& surface : surfaces) put_value(out, surface.coefficients.slope_v);
}

bool read_surfaces(ByteReader& in, std::span<const Block> blocks, std::vector<Surface>& surfaces) {
  surfaces.resize(in.get_varint(blocks.size()));
  for (Surface& surface : surfaces)
    surface.first = get_count(in);  // for now, blocks since the last
  for (Surface& surface : surfaces) surface.length = get_count(in);
  for (Surface& surface : surfaces) surface.coefficients.range = get_value(in);
  for (Surface& surface : surfaces) surface.coefficients.slope_u = get_value(in);
  for (Surface& surface : surfaces) surface.coefficients.slope_v = get_value(in);
  if (!in.ok()) return false;
  std::uint64_t end = 0;
  std::int64_t range = 0;
  for (Surface& surface : surfaces) {
    const std::uint64_t first = end + surface.first;
    end = first + surface.length + 1;
    range += surface.coefficients.range;
    if (end > blocks.size() || blocks[first].row != blocks[end - 1].row) return false;
    if (range < 0 || range > kLargestRange) return false;
    surface.first = static_cast<std::uint32_t>(first);
    ++surface.length;
    surface.coefficients.range = static_cast<std::int32_t>(range);
  }
  return true;
}

}  // namespace sweepcast::rcpcc
