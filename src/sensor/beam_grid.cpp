#include "sensor/beam_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/trig.hpp"
#include "sensor/beam_columns.hpp"
#include "sensor/beam_locate.hpp"
#include "sensor/held_firings.hpp"
#include "sensor/motion.hpp"

namespace sweepcast {
namespace {

constexpr std::size_t kBatch = LocatedPoints::kSize;
ExtraReason why_lost(float x, float y, float z) {
  if (!(std::isfinite(x) && std::isfinite(y) && std::isfinite(z))) return ExtraReason::not_finite;
  return x == 0.0F && y == 0.0F && z == 0.0F ? ExtraReason::zero_range : ExtraReason::stray;
}

}  // namespace

void column_shifts(const SensorModel& model, std::span<const std::int32_t> firing_tick,
                   std::vector<std::int32_t>& shift) {
  shift.assign(model.beams.size(), 0);
  if (firing_tick.size() < 2) return;
  const std::int64_t columns = static_cast<std::int64_t>(firing_tick.size()) - 1;
  const std::int64_t ticks = firing_tick.back() - firing_tick.front();
  // Columns per tick times (lag + offset), rounded; the offset is in 1e-6 degree.
  const std::int64_t turn = std::int64_t{360} * kAngleUnits;
  const std::int64_t divisor = ticks * turn;
  for (std::size_t k = 0; k < shift.size(); ++k) {
    const Beam& beam = model.beams[k];
    const std::int64_t along =
        beam.lag * turn + std::int64_t{beam.azimuth_offset} * model.ticks_per_turn;
    // Halved first: lag, turn and columns together may take 64 bits.
    const std::int64_t scaled = along / 64 * columns;
    const std::int64_t half = divisor / 128;
    shift[k] = static_cast<std::int32_t>((scaled + (scaled < 0 ? -half : half)) / (divisor / 64));
  }
}

struct BeamProjector::State {
  // One point on its way to a cell.
  struct Sample {
    float rho, height_error;  // metres
    float miss;               // ticks from the tick's centre
    std::int32_t range;
  };

  explicit State(const SensorModel& sensor)
      : model(sensor),
        geometry(beam_geometry(sensor)),
        interpolated(interpolated_lags(sensor)),
        locator(sensor) {
    for (const Beam& beam : model.beams) {
      has_time_offsets = has_time_offsets || beam.time_offset != 0;
    }
  }

  void use_copies() {
    px = x;
    py = y;
    pz = z;
  }
  void locate(std::size_t count, const BeamGridOptions& options);
  void locate_batch(std::size_t begin, std::size_t end, const BeamGridOptions& options);
  void undo_mount(const Mount& mount, std::size_t begin, std::size_t end);
  void undo_motion(const Motion& motion, std::size_t begin, std::size_t end);
  void undo_nod(const Motion& motion, std::size_t begin, std::size_t end);
  void shift_times(const Motion& motion, std::size_t begin, std::size_t end);
  void drop_mistimed(const Motion& motion);
  void fill(const BeamGridOptions& options, BeamImage& image);
  [[nodiscard]] bool takes(std::size_t i, const BeamImage& image, std::size_t cell) const;
  void bound_errors(double max_error, BeamImage& image);
  void residuals_of(std::size_t cell, std::size_t i, std::int32_t firing, BeamImage& image) const;
  [[nodiscard]] std::uint32_t index(std::size_t i) const {
    return subset.empty() ? static_cast<std::uint32_t>(i) : subset[i];
  }

  SensorModel model;
  std::vector<BeamGeometry> geometry;
  std::vector<std::int32_t> interpolated;  // by beam; empty where no firing is ever held
  BeamLocator locator;
  LocatedPoints located;
  HeldFirings held_firings;
  ColumnFinder columns;
  bool has_time_offsets = false;

  std::span<const std::uint32_t> subset;
  std::span<const float> px, py, pz;  // the points, in the sensor's frame
  std::vector<float> x, y, z;         // the same, where they had to be copied or moved
  std::vector<float> times;           // of deskewed points
  std::vector<Sample> samples;
  std::vector<FiringPlace> places;
  std::vector<ExtraReason> reasons;      // of points without a place
  std::vector<std::uint32_t> misfits;    // cells beyond the bound
  std::vector<std::uint32_t> sample_of;  // per cell: index into samples
};

// Beam, tick and range of points [begin, end).
void BeamProjector::State::locate_batch(std::size_t begin, std::size_t end,
                                        const BeamGridOptions& options) {
  const std::size_t count = end - begin;
  locator.locate(px.subspan(begin, count), py.subspan(begin, count), pz.subspan(begin, count),
                 static_cast<float>(options.max_height_residual_m), located);
  for (std::size_t i = 0; i < count; ++i) {
    samples[begin + i] = {located.rho[i], located.height_error[i], located.miss[i],
                          located.range[i]};
    const bool found = located.found[i] != 0 && located.range[i] >= options.nearest &&
                       located.range[i] <= options.farthest;
    places[begin + i] = {found ? located.firing[i] : -1,
                         static_cast<std::uint16_t>(located.beam[i])};
    reasons[begin + i] =
        found ? ExtraReason::misfit : why_lost(px[begin + i], py[begin + i], pz[begin + i]);
  }
}

// From the cloud's frame to the sensor's, in place; "no return" stays at the origin.
void BeamProjector::State::undo_mount(const Mount& mount, std::size_t begin, std::size_t end) {
  const Twist<float> twist(mount);
  for (std::size_t i = begin; i < end; ++i) {
    const bool origin = x[i] == 0.0F && y[i] == 0.0F && z[i] == 0.0F;
    const auto p = twist.undo({x[i], y[i], z[i]}, 1.0F);
    x[i] = origin ? 0.0F : p[0];
    y[i] = origin ? 0.0F : p[1];
    z[i] = origin ? 0.0F : p[2];
  }
}

// From deskewed points to the sensor's own, in place. The time is that of the sensor's own azimuth:
// found by going back and forth, which gains a digit or more each time. Loops are such that
// compilers vectorise them.
void BeamProjector::State::undo_motion(const Motion& motion, std::size_t begin, std::size_t end) {
  const Twist<float> twist(motion);
  const float zero =
      static_cast<float>(motion.zero_tick) / static_cast<float>(model.ticks_per_turn);
  std::array<float, kBatch> sx;
  std::array<float, kBatch> sy;
  std::array<float, kBatch> sz;
  const std::size_t count = end - begin;
  std::copy(&x[begin], &x[begin] + count, sx.begin());
  std::copy(&y[begin], &y[begin] + count, sy.begin());
  for (int round = 0; round < 4; ++round) {
    for (std::size_t i = 0; i < count; ++i) {
      float time = arc_tangent_fast(sy[i], sx[i]) * kTurnsPerRadian - zero;
      time = time >= 0.5F ? time - 1.0F : time;
      time = time < -0.5F ? time + 1.0F : time;
      const auto p = twist.undo({x[begin + i], y[begin + i], z[begin + i]}, time);
      times[begin + i] = time;
      sx[i] = p[0];
      sy[i] = p[1];
      sz[i] = p[2];
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    const bool origin = x[begin + i] == 0.0F && y[begin + i] == 0.0F;  // "no return" stays
    x[begin + i] = origin ? 0.0F : sx[i];
    y[begin + i] = origin ? 0.0F : sy[i];
    z[begin + i] = origin ? z[begin + i] : sz[i];
  }
}

// The same where a beam's time is ahead of its azimuth: on from the point that `undo_motion` gave.
void BeamProjector::State::shift_times(const Motion& motion, std::size_t begin, std::size_t end) {
  const Twist<float> twist(motion);
  for (std::size_t i = begin; i < end; ++i) {
    const float rho = std::sqrt(x[i] * x[i] + y[i] * y[i]);
    if (!(rho > 1e-4F && rho < 1e5F)) continue;  // has no place anyway
    const std::size_t k = locator.nearest_beam(rho, z[i]);
    const auto q = twist.redo({x[i], y[i], z[i]}, times[i]);
    const auto p = twist.undo(q, times[i] + static_cast<float>(geometry[k].time_turns));
    x[i] = p[0];
    y[i] = p[1];
    z[i] = p[2];
  }
}

// After the twist, as the beams' last way up or down.
void BeamProjector::State::undo_nod(const Motion& motion, std::size_t begin, std::size_t end) {
  const auto nod = static_cast<float>(nod_of(motion));
  for (std::size_t i = begin; i < end; ++i) z[i] -= nod * std::sqrt(x[i] * x[i] + y[i] * y[i]);
}

void BeamProjector::State::locate(std::size_t count, const BeamGridOptions& options) {
  places.resize(count);
  samples.resize(count);
  reasons.resize(count);
  times.resize(options.motion ? count : 0);
  const Mount& mount = mount_of(model, options.motion);
  const bool mounted = mount != Mount{};
  for (std::size_t begin = 0; begin < count; begin += kBatch) {
    const std::size_t end = std::min(begin + kBatch, count);
    if (mounted) undo_mount(mount, begin, end);
    if (options.motion) undo_motion(*options.motion, begin, end);
    if (options.motion && options.motion->nod != 0) undo_nod(*options.motion, begin, end);
    if (options.motion && has_time_offsets) shift_times(*options.motion, begin, end);
    locate_batch(begin, end, options);
  }
  if (options.motion) drop_mistimed(*options.motion);
}

// Where the sweep begins and ends, a point's time may have settled on one side and its tick on the
// other: the decoder would move it by the whole sweep's motion.
void BeamProjector::State::drop_mistimed(const Motion& motion) {
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].tick < 0) continue;
    const BeamGeometry& g = geometry[places[i].beam];
    const std::int32_t tick = places[i].tick + model.beams[places[i].beam].lag;
    const double time = motion_time(tick, motion, model.ticks_per_turn) +
                        g.phase / model.ticks_per_turn + lateral_turns(g, samples[i].rho);
    if (std::abs(time - times[i]) < 0.25) continue;
    places[i].tick = -1;
    reasons[i] = ExtraReason::stray;
  }
}

// Whether point i is nearer to the cell's azimuth than the point that has it.
bool BeamProjector::State::takes(std::size_t i, const BeamImage& image, std::size_t cell) const {
  const std::int32_t firing = image.firing_tick[cell % static_cast<std::size_t>(image.cols)];
  const std::size_t other = sample_of[cell];
  const auto miss = [&](std::size_t n) {
    return std::abs(static_cast<float>(places[n].tick - firing) + samples[n].miss);
  };
  return miss(i) < miss(other);
}

void BeamProjector::State::fill(const BeamGridOptions& options, BeamImage& image) {
  const int jitter = options.max_error_m > 0.0 ? model.jitter : 0;
  std::span<const std::uint8_t> held;  // by tick
  if (!interpolated.empty()) held = held_firings.find(places, interpolated, model.ticks_per_turn);
  const auto column_of = columns.find(places, held, model.ticks_per_turn,
                                      static_cast<int>(geometry.size()), jitter, image.firing_tick);
  image.held.clear();
  if (!held.empty()) {
    for (const std::int32_t tick : image.firing_tick)
      image.held.push_back(held[static_cast<std::size_t>(tick)]);
  }
  image.rows = static_cast<int>(geometry.size());
  image.cols = static_cast<int>(image.firing_tick.size());
  image.range.assign(image.cells(), 0);
  image.point.assign(image.cells(), kNoPoint);
  image.azimuth_residual.clear();
  image.height_residual.clear();
  image.azimuth_divisor = 1;
  image.height_step = 0;
  image.motion = options.motion;
  image.extras.clear();
  sample_of.resize(image.cells());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const FiringPlace place = places[i];
    if (place.tick < 0) {
      image.extras.push_back({index(i), reasons[i]});
      continue;
    }
    const std::size_t cell =
        place.beam * static_cast<std::size_t>(image.cols) +
        static_cast<std::size_t>(column_of[static_cast<std::size_t>(place.tick)]);
    if (image.range[cell] != 0) {
      const bool wins = takes(i, image, cell);
      image.extras.push_back({wins ? image.point[cell] : index(i), ExtraReason::collision});
      if (!wins) continue;
    }
    image.range[cell] = samples[i].range;
    image.point[cell] = index(i);
    sample_of[cell] = static_cast<std::uint32_t>(i);
  }
  if (options.max_error_m > 0.0) bound_errors(options.max_error_m, image);
  std::sort(image.extras.begin(), image.extras.end(),
            [](const ExtraPoint& a, const ExtraPoint& b) { return a.point < b.point; });
}

// Finds the cells beyond the bound. A few become extras; more get residuals.
void BeamProjector::State::bound_errors(double max_error, BeamImage& image) {
  misfits.clear();
  const double tick = kTwoPi / model.ticks_per_turn;
  const auto tick_size = static_cast<float>(tick);
  const auto bound = static_cast<float>(max_error * max_error);
  float farthest = 0.0F;
  std::uint32_t cell = 0;
  for (int row = 0; row < image.rows; ++row) {
    const auto slope = static_cast<float>(geometry[static_cast<std::size_t>(row)].inverse_slant);
    for (int col = 0; col < image.cols; ++col, ++cell) {
      if (image.range[cell] == 0) continue;
      const std::size_t i = sample_of[cell];
      const Sample& s = samples[i];
      const std::int32_t off = places[i].tick - image.firing_tick[static_cast<std::size_t>(col)];
      const float aside = (static_cast<float>(off) + s.miss) * tick_size * s.rho;
      const float above = s.height_error * slope;
      if (aside * aside + above * above <= bound) continue;
      misfits.push_back(cell);
      farthest = std::max(farthest, s.rho);
    }
  }
  if (misfits.size() * 1000 <= places.size()) {
    for (const std::uint32_t misfit : misfits) {
      image.extras.push_back({image.point[misfit], ExtraReason::misfit});
      image.range[misfit] = 0;
      image.point[misfit] = kNoPoint;
    }
    return;
  }
  // Steps whose halves leave 0.7 of the bound at most, at the farthest point.
  image.height_step = std::max(1, static_cast<std::int32_t>(max_error * kLengthUnits));
  const double divisor = std::ceil(tick * farthest / max_error);
  image.azimuth_divisor = static_cast<std::int32_t>(std::clamp(divisor, 1.0, 4096.0));
  image.azimuth_residual.assign(image.cells(), 0);
  image.height_residual.assign(image.cells(), 0);
  for (const std::uint32_t misfit : misfits) {
    const std::size_t i = sample_of[misfit];
    residuals_of(misfit, i, image.firing_tick[misfit % static_cast<std::size_t>(image.cols)],
                 image);
  }
}

// With a height residual the range is such that rho is exact; z is then off by half a step.
void BeamProjector::State::residuals_of(std::size_t cell, std::size_t i, std::int32_t firing,
                                        BeamImage& image) const {
  const Sample& s = samples[i];
  const BeamGeometry& g = geometry[places[i].beam];
  const double ticks = places[i].tick - firing + static_cast<double>(s.miss);
  image.azimuth_residual[cell] =
      static_cast<std::int32_t>(std::lround(ticks * image.azimuth_divisor));
  const double steps = static_cast<double>(s.height_error) * kLengthUnits / image.height_step;
  image.height_residual[cell] = static_cast<std::int32_t>(std::lround(steps));
  if (image.height_residual[cell] == 0) return;
  image.range[cell] =
      std::max(1, static_cast<std::int32_t>(std::lround(s.rho * g.slant * kRangeUnits)));
}

BeamProjector::BeamProjector(const SensorModel& model) : state_(std::make_unique<State>(model)) {}
BeamProjector::BeamProjector(BeamProjector&&) noexcept = default;
BeamProjector& BeamProjector::operator=(BeamProjector&&) noexcept = default;
BeamProjector::~BeamProjector() = default;

void BeamProjector::project(std::span<const float> x, std::span<const float> y,
                            std::span<const float> z, const BeamGridOptions& options,
                            BeamImage& image) {
  State& s = *state_;
  s.subset = {};
  s.px = x;
  s.py = y;
  s.pz = z;
  if (options.motion || s.model.mount != Mount{}) {  // they are moved
    s.x.assign(x.begin(), x.end());
    s.y.assign(y.begin(), y.end());
    s.z.assign(z.begin(), z.end());
    s.use_copies();
  }
  s.locate(x.size(), options);
  s.fill(options, image);
}

void BeamProjector::project(const CloudView& cloud, const BeamGridOptions& options,
                            BeamImage& image) {
  State& s = *state_;
  s.subset = {};
  for (auto* column : {&s.x, &s.y, &s.z}) column->resize(cloud.size);
  cloud.x.read(0, s.x);
  cloud.y.read(0, s.y);
  cloud.z.read(0, s.z);
  s.use_copies();
  s.locate(cloud.size, options);
  s.fill(options, image);
}

void BeamProjector::project(const CloudView& cloud, std::span<const std::uint32_t> points,
                            const BeamGridOptions& options, BeamImage& image) {
  State& s = *state_;
  for (auto* column : {&s.x, &s.y, &s.z}) column->resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    s.x[i] = static_cast<float>(cloud.x.at(points[i]));
    s.y[i] = static_cast<float>(cloud.y.at(points[i]));
    s.z[i] = static_cast<float>(cloud.z.at(points[i]));
  }
  s.use_copies();
  s.locate(points.size(), options);
  s.subset = points;
  s.fill(options, image);
  s.subset = {};
}

}  // namespace sweepcast
