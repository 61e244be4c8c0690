#include "sensor/motion_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/trig.hpp"
#include "sensor/beam_geometry.hpp"
#include "sensor/motion.hpp"
#include "sensor/motion_equations.hpp"

namespace sweepcast {
namespace {

constexpr double kTurn = 2.0 * kPi;

// What one more unit of each number of the twist does to a point p at time s: s (w x p + v).
struct Influence {
  std::array<double, 6> x, y, z;
};

Influence influence(const std::array<double, 3>& p, double s) {
  return {{s, 0, 0, 0, s * p[2], -s * p[1]},
          {0, s, 0, -s * p[2], 0, s * p[0]},
          {0, 0, s, s * p[1], -s * p[0], 0}};
}

// A car: 1 m and 0.1 m a turn, hundredths of a radian.
constexpr TwistVector kPrior{1.0, 1.0, 100.0, 1e4, 1e4, 100.0};

double robust(double residual, double scale) {
  const double e = residual / scale;
  const double f = 1.0 + e * e;
  return 1.0 / (f * f * scale * scale);
}

double wrap(double phase) {
  return phase - std::floor(phase + 0.5);
}

void add_to(TwistVector& twist, const TwistVector& step) {
  for (std::size_t i = 0; i < 6; ++i) twist[i] += step[i];
}

}  // namespace

Motion quantised_motion(const TwistVector& twist) {
  Motion motion;
  for (std::size_t i = 0; i < 3; ++i) {
    motion.translation[i] = static_cast<std::int32_t>(std::lround(twist[i] * kLengthUnits));
    motion.rotation[i] =
        static_cast<std::int32_t>(std::lround(twist[i + 3] / kDegree * kAngleUnits));
  }
  return motion;
}

TwistVector twist_vector(const Motion& motion) {
  TwistVector twist{};
  for (std::size_t i = 0; i < 3; ++i) {
    twist[i] = static_cast<double>(motion.translation[i]) / kLengthUnits;
    twist[i + 3] = static_cast<double>(motion.rotation[i]) / kAngleUnits * kDegree;
  }
  return twist;
}

void undo_motion(const CloudView& cloud, const Motion& motion, PointCloud& own) {
  const Twist<double> twist(motion);
  own.clear();
  own.resize_xyz(cloud.size);
  for (std::size_t i = 0; i < cloud.size; ++i) {
    const std::array<double, 3> q{cloud.x.at(i), cloud.y.at(i), cloud.z.at(i)};
    std::array<double, 3> p = q;
    if (q[0] * q[0] + q[1] * q[1] > 1e-8) {
      for (int round = 0; round < 4; ++round) p = twist.undo(q, arc_tangent(p[1], p[0]) / kTurn);
    }
    own.x[i] = static_cast<float>(p[0]);
    own.y[i] = static_cast<float>(p[1]);
    own.z[i] = static_cast<float>(p[2]);
  }
}

MotionFitter::MotionFitter(const CloudView& cloud, std::size_t stride) {
  for (std::size_t i = 0; i < cloud.size; i += stride) {
    const std::array<float, 3> p{static_cast<float>(cloud.x.at(i)),
                                 static_cast<float>(cloud.y.at(i)),
                                 static_cast<float>(cloud.z.at(i))};
    const float rho = std::sqrt(p[0] * p[0] + p[1] * p[1]);
    if (rho > 0.5F && rho < 1e4F && std::abs(p[2]) < 1e4F) points_.push_back(p);
  }
  own_.resize(points_.size());
  time_.resize(points_.size());
  rho_.resize(points_.size());
  z_.resize(points_.size());
}

void MotionFitter::undo(const TwistVector& twist) {
  const Twist<double> own_motion(quantised_motion(twist));
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const std::array<double, 3> q{points_[i][0], points_[i][1], points_[i][2]};
    std::array<double, 3> p = q;
    double s = 0.0;
    for (int round = 0; round < 3; ++round) {
      s = arc_tangent(p[1], p[0]) / kTurn;
      p = own_motion.undo(q, s);
    }
    own_[i] = p;
    time_[i] = s;
    rho_[i] = static_cast<float>(std::sqrt(p[0] * p[0] + p[1] * p[1]));
    z_[i] = static_cast<float>(p[2]);
  }
}

void MotionFitter::assign(std::span<const BeamLine> lines) {
  assign_lines({rho_, z_}, lines, beam_);
}

// One Gauss-Newton step on the heights of the points at most `reach` turns from the front.
TwistVector MotionFitter::height_step(std::span<const BeamLine> lines, bool lines_free,
                                      double reach, double scale, TwistVector twist) {
  TwistEquations equations(lines.size());
  for (std::size_t i = 0; i < own_.size(); ++i) {
    if (std::abs(time_[i]) > reach) continue;
    const BeamLine& line = lines[beam_[i]];
    const auto& p = own_[i];
    const double rho = rho_[i];
    const double e = p[2] - (rho * line.tan + line.height);
    const Influence d = influence(p, time_[i]);
    std::array<double, 6> slope{};
    for (std::size_t n = 0; n < 6; ++n) {
      slope[n] = d.z[n] - line.tan * (p[0] * d.x[n] + p[1] * d.y[n]) / rho;
    }
    equations.add(beam_[i], robust(e, scale), rho, e, slope);
  }
  const double yaw = twist[5];
  add_to(twist, equations.solve(lines_free, kPrior, twist));
  twist[5] = yaw;  // heights do not show it
  return twist;
}

std::optional<TwistVector> MotionFitter::bootstrap(int max_beams) {
  TwistVector twist{};
  undo(twist);
  std::vector<float> rho, z;
  for (std::size_t i = 0; i < own_.size(); ++i) {
    if (std::abs(time_[i]) > 25.0 / 360.0) continue;
    rho.push_back(rho_[i]);
    z.push_back(z_[i]);
  }
  lines_ = find_beam_lines({rho, z}, {max_beams, 0.004});
  if (lines_.empty()) return std::nullopt;
  for (const double degrees : {30.0, 45.0, 65.0, 90.0, 120.0, 150.0, 181.0}) {
    for (const double scale : {0.03, 0.015, 0.01}) {
      assign(lines_);
      refine_lines({rho_, z_}, beam_, scale, lines_);
      twist = height_step(lines_, true, degrees / 360.0, scale, twist);
      undo(twist);
    }
  }
  return settle(max_beams, twist);
}

std::optional<TwistVector> MotionFitter::settle(int max_beams, TwistVector twist) {
  undo(twist);
  for (const double scale : {0.01, 0.005, 0.003, 0.002, 0.002, 0.002}) {
    if (scale == 0.005 || scale == 0.003) {
      lines_ = find_beam_lines({rho_, z_}, {max_beams, scale / 2.0});
      if (lines_.empty()) return std::nullopt;
    }
    assign(lines_);
    refine_lines({rho_, z_}, beam_, scale, lines_);
    twist = height_step(lines_, true, 1.0, scale, twist);
    undo(twist);
  }
  assign(lines_);
  return twist;
}

TwistVector MotionFitter::straighten(const SensorModel& model, const TwistVector* guess) {
  lines_.clear();
  for (const BeamGeometry& beam : beam_geometry(model)) {
    lines_.push_back({beam.tan, beam.height_m, 0});
  }
  TwistVector twist = guess != nullptr ? *guess : TwistVector{};
  undo(twist);
  const auto step = [&](double reach, double scale) {
    assign(lines_);
    twist = height_step(lines_, false, reach, scale, twist);
    undo(twist);
  };
  if (guess == nullptr) {
    for (const double degrees : {30.0, 45.0, 65.0, 90.0, 120.0, 150.0, 181.0}) {
      step(degrees / 360.0, 0.02);
      step(degrees / 360.0, 0.01);
    }
  }
  for (const double scale : {0.02, 0.01, 0.005, 0.002, 0.002}) step(1.0, scale);
  assign(lines_);
  return twist;
}

int MotionFitter::find_ticks() {
  std::vector<std::size_t> order(own_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
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
  std::vector<double> coherence;
  for (const int ticks : encoder_ticks()) {
    double sum = 0.0;
    for (const double step : steps) sum += sin_cos(kTurn * wrap(step * ticks)).cos;
    coherence.push_back(sum / static_cast<double>(steps.size()));
  }
  const double best = *std::max_element(coherence.begin(), coherence.end());
  if (best < 0.5) return 0;
  for (std::size_t c = 0; c < coherence.size(); ++c) {
    if (coherence[c] > 0.9 * best) return encoder_ticks()[c];
  }
  return 0;
}

void MotionFitter::find_yaw(int ticks_per_turn, const SensorModel* model, double centre,
                            double reach, TwistVector& twist) {
  constexpr std::size_t kBeams = 8;
  constexpr std::size_t kPoints = 400;
  struct Sample {
    double time, inverse_rho;
  };
  std::vector<std::vector<Sample>> samples(lines_.size());
  for (std::size_t i = 0; i < own_.size(); ++i) {
    if (rho_[i] > 6.0F) samples[beam_[i]].push_back({time_[i], 1.0 / rho_[i]});
  }
  std::vector<std::size_t> order(samples.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return samples[a].size() > samples[b].size(); });
  order.resize(std::min(order.size(), kBeams));
  const double turned = twist[5];  // already undone
  const auto coherence = [&](double yaw) {
    const double stretch = 1.0 + (yaw - turned) / kTurn;  // times are azimuths, in turns
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
          const double turn = s.time * stretch - lateral * s.inverse_rho / kTurn;
          const SinCos at = sin_cos(kTurn * wrap(turn * ticks_per_turn));
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
  twist[5] = found;
}

TwistVector MotionFitter::refine(const SensorModel& model, TwistVector twist) {
  const std::vector<BeamGeometry> beams = beam_geometry(model);
  for (const double scale : {0.004, 0.002, 0.002}) {
    undo(twist);
    assign(lines_);
    TwistEquations equations(0);
    for (std::size_t i = 0; i < own_.size(); ++i) {
      const BeamGeometry& beam = beams[beam_[i]];
      const auto& p = own_[i];
      const double rho = rho_[i];
      const Influence d = influence(p, time_[i]);
      const double height = p[2] - (rho * beam.tan + beam.height_m);
      std::array<double, 6> slope{};
      for (std::size_t n = 0; n < 6; ++n) {
        slope[n] = d.z[n] - beam.tan * (p[0] * d.x[n] + p[1] * d.y[n]) / rho;
      }
      equations.add(robust(height, scale), height, slope);
      if (rho < 2.0) continue;
      const double at = (time_[i] - lateral_turns(beam, rho)) * model.ticks_per_turn - beam.phase;
      const double aside = wrap(at) / model.ticks_per_turn * kTurn * rho;
      for (std::size_t n = 0; n < 6; ++n) slope[n] = (p[0] * d.y[n] - p[1] * d.x[n]) / rho;
      equations.add(robust(aside, scale), aside, slope);
    }
    add_to(twist, equations.solve(false, kPrior, twist));
  }
  undo(twist);
  return twist;
}

Motion estimate_motion(const CloudView& cloud, const SensorModel& model, const Motion* guess) {
  constexpr double kMaxYawChange = 0.03;  // radians a turn, from one sweep to the next
  const std::size_t enough = guess != nullptr ? 12'000 : 40'000;  // points
  MotionFitter fitter(cloud, std::max<std::size_t>(1, cloud.size / enough));
  if (fitter.empty()) return guess != nullptr ? *guess : Motion{};
  if (guess == nullptr) {
    TwistVector twist = fitter.straighten(model, nullptr);
    fitter.find_yaw(model.ticks_per_turn, &model, 0.0, kMaxYaw, twist);
    return quantised_motion(fitter.refine(model, twist));
  }
  const TwistVector start = twist_vector(*guess);
  TwistVector twist = fitter.straighten(model, &start);
  fitter.find_yaw(model.ticks_per_turn, &model, start[5], kMaxYawChange, twist);
  return quantised_motion(fitter.refine(model, twist));
}

}  // namespace sweepcast
