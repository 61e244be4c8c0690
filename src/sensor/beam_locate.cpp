#include "sensor/beam_locate.hpp"

#include <algorithm>
#include <cmath>

#include "core/cpu.hpp"
#include "core/trig.hpp"
#include "sensor/beam_geometry.hpp"

namespace sweepcast {
namespace {

constexpr float kMaxRange = 1.0e5F;  // metres: 0.1 mm of it fit 32 bits

// Nearest integer; the compiler makes one instruction of it, which std::lround is not.
[[gnu::always_inline]] inline std::int32_t nearest(float value) {
  return static_cast<std::int32_t>(value + (value < 0.0F ? -0.5F : 0.5F));
}

}  // namespace

BeamLocator::BeamLocator(const SensorModel& model)
    : ticks_(model.ticks_per_turn), table_(lines_of(beam_geometry(model))) {
  const std::vector<BeamGeometry> beams = beam_geometry(model);
  for (std::size_t k = 0; k < beams.size(); ++k) {
    const BeamGeometry& beam = beams[k];
    beams_.push_back({static_cast<float>(beam.tan), static_cast<float>(beam.inverse_slant),
                      static_cast<float>(beam.height_m), static_cast<float>(beam.lateral_m),
                      static_cast<float>(beam.phase), model.beams[k].lag});
  }
}

// Loops without branches, so that they vectorise with whatever instructions the caller may use.
[[gnu::always_inline]] inline void BeamLocator::locate_points(std::span<const float> x,
                                                              std::span<const float> y,
                                                              std::span<const float> z,
                                                              float max_height_error,
                                                              LocatedPoints& out) const {
  const std::size_t count = std::min(x.size(), LocatedPoints::kSize);
  std::array<float, LocatedPoints::kSize> inverses;
  std::array<float, LocatedPoints::kSize> heights;
  for (std::size_t i = 0; i < count; ++i) {
    const float rho = std::sqrt(x[i] * x[i] + y[i] * y[i]);
    const std::int32_t is_near = rho < kMaxRange ? 1 : 0;
    const std::int32_t is_off_axis = rho > 1e-4F ? 1 : 0;
    const std::int32_t is_level = std::abs(z[i]) < kMaxRange ? 1 : 0;
    const std::int32_t found = is_near & is_off_axis & is_level;
    out.found[i] = found;
    out.rho[i] = found != 0 ? rho : 1.0F;
    heights[i] = found != 0 ? z[i] : 0.0F;
    inverses[i] = 1.0F / out.rho[i];
    const float turns = arc_tangent_fast(y[i], x[i]) * kTurnsPerRadian;
    out.turns[i] = found != 0 ? turns : 0.0F;
  }
  const LineTable::View table = table_.view();
  std::int32_t* const beam_of = out.beam.data();
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    beam_of[i] = table.guess(out.rho[i], heights[i], inverses[i]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    beam_of[i] = table_.walk(beam_of[i], out.rho[i], heights[i]);
  }
  const Beam* const beams = beams_.data();
  const std::int32_t turn = ticks_;
  const auto ticks = static_cast<float>(ticks_);
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const Beam& beam = beams[beam_of[i]];
    const float rho = out.rho[i];
    const float above = heights[i] - beam.height;
    const float error = above - rho * beam.tan;
    const float along = (rho + above * beam.tan) * beam.inverse_slant;
    const float sine = beam.lateral * inverses[i];
    const std::int32_t is_aside = std::abs(sine) <= 0.5F ? 1 : 0;
    const float q = is_aside != 0 ? sine : 0.0F;
    const float aside = (q + q * q * q * (1.0F / 6.0F)) * kTurnsPerRadian;  // arc sine
    const float at = (out.turns[i] - aside) * ticks - beam.phase;
    const std::int32_t tick = nearest(at);
    std::int32_t firing = tick - beam.lag;  // at most two turns off
    firing += firing < 0 ? turn : 0;
    firing += firing < 0 ? turn : 0;
    firing -= firing >= turn ? turn : 0;
    firing -= firing >= turn ? turn : 0;
    const std::int32_t is_near = std::abs(error) <= max_height_error ? 1 : 0;
    const std::int32_t is_ahead = along > 1e-4F ? 1 : 0;
    const std::int32_t is_within = along < kMaxRange ? 1 : 0;
    out.found[i] &= is_near & is_ahead & is_within & is_aside;
    out.height_error[i] = error;
    out.miss[i] = at - static_cast<float>(tick);
    out.firing[i] = firing;
    out.range[i] = nearest((is_within != 0 ? along : 0.0F) * kRangeUnits);
  }
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void BeamLocator::locate_avx2(std::span<const float> x,
                                                      std::span<const float> y,
                                                      std::span<const float> z,
                                                      float max_height_error,
                                                      LocatedPoints& out) const {
  locate_points(x, y, z, max_height_error, out);
}
#endif

void BeamLocator::locate(std::span<const float> x, std::span<const float> y,
                         std::span<const float> z, float max_height_error,
                         LocatedPoints& out) const {
#if defined(__x86_64__)
  if (has_avx2()) return locate_avx2(x, y, z, max_height_error, out);
#endif
  locate_points(x, y, z, max_height_error, out);
}

}  // namespace sweepcast
