// The motion of a deskewed sweep with nothing known; motion_fit.cpp has what follows from a model.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/trig.hpp"
#include "sensor/motion.hpp"
#include "sensor/motion_equations.hpp"
#include "sensor/motion_fit.hpp"
#include "sensor/mount_search.hpp"

namespace sweepcast {
namespace {

// What a point costs that is off by `error` metres: 0 to 1.
double cost(double error, double scale) {
  const double e = error * error / (scale * scale);
  return e / (1.0 + e);
}

// The fewest ticks a turn of which stretched steps are as good as whole multiples, best for any;
// 0 where none is as coherent as `least`.
int ticks_of(const std::vector<double>& steps, double stretch, double least) {
  std::vector<double> coherence;
  for (const int ticks : encoder_ticks()) {
    double sum = 0.0;
    for (const double step : steps) sum += unit_phasor(wrap(step * stretch * ticks)).cos;
    coherence.push_back(sum / static_cast<double>(steps.size()));
  }
  const double best = *std::max_element(coherence.begin(), coherence.end());
  if (best < least) return 0;
  for (std::size_t c = 0; c < coherence.size(); ++c) {
    if (coherence[c] > 0.95 * best) return encoder_ticks()[c];
  }
  return 0;
}

}  // namespace

// From lines that are blurred to crisp ones.
void MotionFitter::relax(MotionVector& motion) {
  const MotionVector start = motion;
  undo(motion);
  for (const double scale : {0.03, 0.03, 0.02, 0.02, 0.015, 0.01, 0.01}) {
    motion = step_on_lines(scale, start, motion);
    undo(motion);
  }
  assign(lines_);
}

// Where the sweep begins and ends the time jumps by a turn: looks for the place near the present
// one where that fits best.
void MotionFitter::find_cut(const MotionVector& motion) {
  constexpr int kSteps = 120;
  constexpr double kStep = 0.25 / 360.0;
  constexpr double kChance = 0.1;  // what a point must gain at least
  const Motion quantised = quantised_motion(motion, 0);
  const Twist<double> twist(quantised);
  const Twist<double> mount(quantised.mount);
  const LineTable table(lines_);
  // By distance from the present place, before and after it: what changes if the point moves over.
  std::array<std::array<double, kSteps>, 2> change{};
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const auto step = static_cast<std::size_t>((0.5 - std::abs(time_[i])) / kStep);
    if (step >= kSteps) continue;
    const auto mounted = mount.undo({points_[i][0], points_[i][1], points_[i][2]}, 1.0);
    const auto p = twist.undo(mounted, time_[i] > 0.0 ? time_[i] - 1.0 : time_[i] + 1.0);
    const auto rho = static_cast<float>(std::sqrt(p[0] * p[0] + p[1] * p[1]));
    const BeamLine& line = lines_[table.nearest(std::max(rho, 0.1F), static_cast<float>(p[2]))];
    const double error = p[2] - (rho * line.tan + line.height);
    change[time_[i] > 0.0 ? 1 : 0][step] +=
        kChance + cost(error, 0.005) - cost(height_error(i), 0.005);
  }
  double best = 0.0;
  double shift = 0.0;
  for (std::size_t side = 0; side < 2; ++side) {
    double total = 0.0;
    for (std::size_t step = 0; step < kSteps; ++step) {
      total += change[side][step];
      if (total >= best) continue;
      best = total;
      shift = (side == 0 ? 1.0 : -1.0) * static_cast<double>(step + 1) * kStep;
    }
  }
  zero_ = wrap(zero_ + shift);
}

std::optional<MotionVector> MotionFitter::bootstrap(int max_beams) {
  constexpr int kZeros = 8;
  const MotionVector mount = search_mount(points_);
  MotionVector best = mount;
  double sharpest = 0.0;
  // Found without the twist, the place aside may be the twist's doing: none is a start, too.
  MotionVector amidst = mount;
  amidst[6] = 0.0;
  amidst[7] = 0.0;
  for (int n = 0; n < kZeros; ++n) {
    const double zero = wrap(static_cast<double>(n) / kZeros);
    for (MotionVector motion : {mount, amidst}) {
      const double sharpness = search_twist(points_, zero, motion);
      if (sharpness <= sharpest) continue;
      sharpest = sharpness;
      best = motion;
      zero_ = zero;
    }
  }
  for (int round = 0; round < 3; ++round) {
    undo(best);
    lines_ = find_beam_lines({rho_, z_}, {max_beams, round == 0 ? 0.01 : 0.004});
    if (lines_.empty()) return std::nullopt;
    relax(best);
  }
  find_cut(best);
  auto motion = settle(max_beams, best);
  if (!motion) return std::nullopt;
  find_cut(*motion);
  return settle(max_beams, *motion);
}

std::optional<MotionVector> MotionFitter::settle(int max_beams, MotionVector motion) {
  const MotionVector start = motion;
  undo(motion);
  for (const double scale : {0.01, 0.005, 0.003, 0.002, 0.002, 0.002}) {
    if (scale == 0.005 || scale == 0.003) {
      lines_ = find_beam_lines({rho_, z_}, {max_beams, scale / 2.0});
      if (lines_.empty()) return std::nullopt;
    }
    motion = step_on_lines(scale, start, motion);
    undo(motion);
  }
  assign(lines_);
  return motion;
}

int MotionFitter::find_ticks() {
  std::vector<std::size_t> order(own_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return beam_[a] != beam_[b] ? beam_[a] < beam_[b] : time_[a] < time_[b];
  });
  std::vector<double> steps;
  for (std::size_t n = 1; n < order.size() && steps.size() < 20'000; ++n) {
    const std::size_t a = order[n - 1];
    const std::size_t b = order[n];
    const double apart = time_[b] - time_[a];
    const bool same_distance = std::abs(1.0 / rho_[a] - 1.0 / rho_[b]) < 1e-3;
    if (beam_[a] == beam_[b] && rho_[a] > 5.0F && same_distance && apart < 0.008) {
      steps.push_back(apart);
    }
  }
  if (steps.size() < 200) return 0;
  // A fast turn about z stretches steps so much that fewer ticks seem to fit them; slow ones first.
  constexpr double kStretch = 0.002;
  constexpr int kMost = static_cast<int>(kMaxYaw / kTwoPi / kStretch);
  for (int n = 0; n <= kMost; ++n) {
    for (const double stretch : {1.0 + n * kStretch, 1.0 - n * kStretch}) {
      if (const int ticks = ticks_of(steps, stretch, 0.9); ticks != 0) return ticks;
    }
  }
  return ticks_of(steps, 1.0, 0.5);
}

void MotionFitter::find_yaw(int ticks_per_turn, const SensorModel* model, double centre,
                            double reach, MotionVector& motion) {
  constexpr std::size_t kBeams = 8;
  constexpr std::size_t kPoints = 400;
  struct Sample {
    double time, inverse_rho;
  };
  std::vector<std::vector<Sample>> samples(lines_.size());
  for (std::size_t i = 0; i < own_.size(); ++i) {
    if (rho_[i] > 6.0F) {
      const double azimuth = time_[i] - (time_offsets_.empty() ? 0.0 : time_offsets_[beam_[i]]);
      samples[beam_[i]].push_back({azimuth, 1.0 / rho_[i]});
    }
  }
  std::vector<std::size_t> order(samples.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return samples[a].size() > samples[b].size();
  });
  order.resize(std::min(order.size(), kBeams));
  const double turned = motion[5];  // already undone
  const auto coherence = [&](double yaw) {
    const double stretch = 1.0 + (yaw - turned) / kTwoPi;  // times are azimuths, in turns
    double total = 0.0;
    for (const std::size_t k : order) {
      const std::size_t stride = samples[k].size() / kPoints + 1;
      double best = 0.0;
      const int laterals = model != nullptr ? 0 : 5;
      for (int w = -laterals; w <= laterals; ++w) {
        const double lateral =
            model != nullptr ? static_cast<double>(model->beams[k].lateral_offset) / kLengthUnits
                             : w * 0.0065;
        double re = 0.0;
        double im = 0.0;
        for (std::size_t i = 0; i < samples[k].size(); i += stride) {
          const Sample& s = samples[k][i];
          const double turn = s.time * stretch - lateral * s.inverse_rho / kTwoPi;
          const SinCos at = unit_phasor(wrap(turn * ticks_per_turn));
          re += at.cos;
          im += at.sin;
        }
        best = std::max(best, re * re + im * im);
      }
      total += std::sqrt(best);
    }
    return total;
  };
  double best = 0.0;
  double found = turned;
  const auto search = [&](double middle, double range, double step) {
    const int steps = static_cast<int>(range / step);
    for (int n = -steps; n <= steps; ++n) {
      const double yaw = middle + n * step;
      if (const double here = coherence(yaw); here > best) {
        best = here;
        found = yaw;
      }
    }
  };
  const double step = 1.5 / ticks_per_turn;
  search(centre, reach, step);
  search(found, step, step / 10.0);
  motion[5] = found;
}

}  // namespace sweepcast
