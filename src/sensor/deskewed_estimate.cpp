// A sensor's model from deskewed sweeps, or from ones in another frame than the sensor's.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

#include "sensor/motion_fit.hpp"
#include "sensor/sensor_estimate.hpp"

namespace sweepcast {
namespace {

// The motion of a deskewed sweep, no model known, and where its time is 0, turns.
struct BlindMotion {
  MotionVector motion{};
  double zero = 0.0;
};

// Fills in `ticks_per_turn` where the azimuths show it.
std::optional<BlindMotion> find_motion(const CloudView& sweep, SensorEstimateOptions& options) {
  constexpr std::size_t kPoints = 25'000;
  MotionFitter fitter(sweep, std::max<std::size_t>(1, sweep.size / kPoints));
  if (fitter.empty()) return std::nullopt;
  auto motion = fitter.bootstrap(options.max_beams);
  if (!motion) return std::nullopt;
  if (options.ticks_per_turn == 0) options.ticks_per_turn = fitter.find_ticks();
  if (options.ticks_per_turn != 0) {
    // The lines were straightened without the turn about z; once it is known, better.
    fitter.find_yaw(options.ticks_per_turn, nullptr, 0.0, kMaxYaw, *motion);
    for (int round = 0; round < 2; ++round) {
      const auto settled = fitter.settle(options.max_beams, *motion);
      if (!settled) break;
      motion = settled;
      fitter.find_yaw(options.ticks_per_turn, nullptr, (*motion)[5], 0.01, *motion);
    }
  }
  return BlindMotion{*motion, fitter.zero()};
}

// Sets the beams' time offsets, as far as the motions show them; small ones are chance.
void fit_time_offsets(std::span<const CloudView> sweeps, std::span<Motion> motions,
                      SensorModel& model) {
  constexpr double kExpected = 0.02;  // turns
  constexpr std::size_t kPoints = 50'000;
  constexpr std::int32_t kChance = kAngleUnits * 3 / 10;
  for (int round = 0; round < 3; ++round) {
    std::vector<TimeOffsetSums> sums(model.beams.size());
    for (std::size_t n = 0; n < sweeps.size(); ++n) {
      const double zero = static_cast<double>(motions[n].zero_tick) / model.ticks_per_turn;
      MotionFitter fitter(sweeps[n], std::max<std::size_t>(1, sweeps[n].size / kPoints), zero);
      MotionVector motion = fitter.straighten(model, motion_vector(motions[n]), false);
      motion = fitter.refine(model, motion);
      fitter.add_time_offsets(model, motion, sums);
      motions[n] = quantised_motion(motion, motions[n].zero_tick);
    }
    for (std::size_t k = 0; k < sums.size(); ++k) {
      Beam& beam = model.beams[k];
      const double turns = static_cast<double>(beam.time_offset) / (360.0 * kAngleUnits) -
                           sums[k].product / (sums[k].square + 1.0 / (kExpected * kExpected));
      beam.time_offset = static_cast<std::int32_t>(
          std::lround(std::clamp(turns, -0.2, 0.2) * 360.0 * kAngleUnits));
    }
  }
  if (std::all_of(model.beams.begin(), model.beams.end(),
                  [](const Beam& beam) { return std::abs(beam.time_offset) < kChance; })) {
    for (Beam& beam : model.beams) beam.time_offset = 0;
  }
}

}  // namespace

Result<SensorEstimate> estimate_deskewed(std::span<const CloudView> sweeps,
                                         SensorEstimateOptions options) {
  const auto blind = find_motion(sweeps.front(), options);
  if (!blind) {
    return fail(ErrorCode::unsupported, "no beams of a spinning LiDAR in these points");
  }
  std::vector<PointCloud> own(sweeps.size());
  undo_motion(sweeps.front(), blind->motion, blind->zero, nullptr, own.front());
  std::vector<CloudView> views{own.front()};
  auto estimate = estimate_still(views, false, options);
  if (!estimate) return estimate;
  const auto turn = static_cast<double>(estimate->model.ticks_per_turn);
  const auto zero_tick = static_cast<int>(std::lround((blind->zero + 1.0) * turn));
  Motion guess = quantised_motion(blind->motion, zero_tick % estimate->model.ticks_per_turn);
  std::vector<Motion> motions{estimate_motion(sweeps.front(), estimate->model, &guess)};
  fit_time_offsets(sweeps.first(1), motions, estimate->model);
  guess = motions.front();
  motions.clear();
  views.clear();
  for (std::size_t n = 0; n < sweeps.size(); ++n) {
    guess = estimate_motion(sweeps[n], estimate->model, &guess);
    motions.push_back(guess);
    undo_motion(sweeps[n], motion_vector(guess), guess.zero_tick / turn, &estimate->model, own[n]);
    views.emplace_back(own[n]);
  }
  options.ticks_per_turn = estimate->model.ticks_per_turn;
  estimate = estimate_still(views, false, options);
  if (!estimate) return estimate;
  estimate->model.mount = motions.front().mount;
  fit_time_offsets(sweeps, motions, estimate->model);
  estimate->motions = std::move(motions);
  return estimate;
}

void fill_motions(std::span<const CloudView> sweeps, SensorEstimate& estimate) {
  Motion guess = estimate.motions.front();
  estimate.motions.clear();
  for (const CloudView& sweep : sweeps) {
    guess = estimate_motion(sweep, estimate.model, &guess);
    estimate.motions.push_back(guess);
  }
}

}  // namespace sweepcast
