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

constexpr double kFixed = 1e12;  // weight of a prior that holds a number where it is

// What one more unit of each number does to a residual that moves with `slope` in the sensor's
// frame, for a point p at time s: the twist moves p by s (w x p + v), the mount by w x p + v.
MotionVector influence(const std::array<double, 3>& p, double s,
                       const std::array<double, 3>& slope) {
  const std::array<double, 3> turn{p[1] * slope[2] - p[2] * slope[1],
                                   p[2] * slope[0] - p[0] * slope[2],
                                   p[0] * slope[1] - p[1] * slope[0]};
  MotionVector all{};
  for (std::size_t i = 0; i < 3; ++i) {
    all[i] = s * slope[i];
    all[3 + i] = s * turn[i];
    all[6 + i] = slope[i];
    all[9 + i] = turn[i];
  }
  return all;
}

// A car: 1 m and 0.1 m a turn, hundredths of a radian; about 0. The mount: decimetres and a few
// thousandths of a radian from what was found without the twist.
MotionPrior prior_unknown(const MotionVector& seed) {
  MotionPrior prior{{1.0, 1.0, 100.0, 1e4, 1e4, 100.0, 4.0, 4.0, 4.0, 2e3, 2e3, 2e3, 4e6}, seed};
  std::fill_n(prior.about.begin(), 6, 0.0);
  return prior;
}

// What changes from sweep to sweep: half a metre a second, a few degrees a second. The nod is about
// 0, half a milliradian.
MotionPrior prior_near(const MotionVector& guess) {
  MotionPrior prior{{400.0, 400.0, 2500.0, 4e4, 4e4, 2500.0, 1e3, 1e3, 1e3, 4e4, 4e4, 4e4, 4e6},
                    guess};
  prior.about[kNod] = 0.0;
  return prior;
}

void hold(MotionPrior& prior, std::size_t number, const MotionVector& motion) {
  prior.weight[number] = kFixed;
  prior.about[number] = motion[number];
}

double robust(double residual, double scale) {
  const double e = residual / scale;
  const double f = 1.0 + e * e;
  return 1.0 / (f * f * scale * scale);
}

void add_to(MotionVector& motion, const MotionVector& step) {
  for (std::size_t i = 0; i < motion.size(); ++i) motion[i] += step[i];
}

// Both parts of a motion, ready to be undone.
struct Undoing {
  explicit Undoing(const Motion& motion) : twist(motion), mount(motion.mount) {}

  Twist<double> twist, mount;
};

}  // namespace

Motion quantised_motion(const MotionVector& motion, int zero_tick) {
  const auto length = [](double metres) {
    return static_cast<std::int32_t>(std::lround(metres * kLengthUnits));
  };
  const auto angle = [](double radians) {
    return static_cast<std::int32_t>(std::lround(radians / kDegree * kAngleUnits));
  };
  Motion result;
  for (std::size_t i = 0; i < 3; ++i) {
    result.translation[i] = length(motion[i]);
    result.rotation[i] = angle(motion[i + 3]);
    result.mount.translation[i] = length(motion[i + 6]);
    result.mount.rotation[i] = angle(motion[i + 9]);
  }
  result.nod = static_cast<std::int32_t>(std::lround(motion[kNod] * kTangentUnits));
  result.zero_tick = zero_tick;
  return result;
}

MotionVector motion_vector(const Motion& motion) {
  MotionVector vector{};
  for (std::size_t i = 0; i < 3; ++i) {
    vector[i] = static_cast<double>(motion.translation[i]) / kLengthUnits;
    vector[i + 3] = static_cast<double>(motion.rotation[i]) / kAngleUnits * kDegree;
    vector[i + 6] = static_cast<double>(motion.mount.translation[i]) / kLengthUnits;
    vector[i + 9] = static_cast<double>(motion.mount.rotation[i]) / kAngleUnits * kDegree;
  }
  vector[kNod] = nod_of(motion);
  return vector;
}

void undo_motion(const CloudView& cloud, const MotionVector& motion, double zero,
                 const SensorModel* model, PointCloud& own) {
  const Undoing undoing(quantised_motion(motion, 0));
  std::vector<BeamGeometry> beams;
  if (model != nullptr) beams = beam_geometry(*model);
  const LineTable table = model != nullptr ? LineTable(lines_of(beams)) : LineTable();
  own.clear();
  own.resize_xyz(cloud.size);
  for (std::size_t i = 0; i < cloud.size; ++i) {
    const std::array<double, 3> q{cloud.x.at(i), cloud.y.at(i), cloud.z.at(i)};
    std::array<double, 3> p = q;
    if (q[0] * q[0] + q[1] * q[1] > 1e-8) {
      const auto mounted = undoing.mount.undo(q, 1.0);
      p = mounted;
      for (int round = 0; round < 4; ++round) {
        double s = wrap(arc_tangent(p[1], p[0]) / kTwoPi - zero);
        if (model != nullptr) {
          const double rho = std::sqrt(p[0] * p[0] + p[1] * p[1]);
          s += beams[table.nearest(static_cast<float>(rho), static_cast<float>(p[2]))].time_turns;
        }
        p = undoing.twist.undo(mounted, s);
        p[2] -= motion[kNod] * std::sqrt(p[0] * p[0] + p[1] * p[1]);
      }
    }
    own.x[i] = static_cast<float>(p[0]);
    own.y[i] = static_cast<float>(p[1]);
    own.z[i] = static_cast<float>(p[2]);
  }
}

MotionFitter::MotionFitter(const CloudView& cloud, std::size_t stride, double zero) : zero_(zero) {
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

// In floats and in batches, so that compilers vectorise it: this takes most of the time.
void MotionFitter::undo(const MotionVector& motion) {
  constexpr std::size_t kBatch = 256;
  const Motion quantised = quantised_motion(motion, 0);
  const Twist<float> twist(quantised);
  const Twist<float> mount(quantised.mount);
  const auto zero = static_cast<float>(zero_);
  const auto nod = static_cast<float>(nod_of(quantised));
  using Batch = std::array<float, kBatch>;
  std::array<Batch, 3> mounted{};
  std::array<Batch, 3> own{};
  Batch time{};
  Batch ahead{};
  for (std::size_t begin = 0; begin < points_.size(); begin += kBatch) {
    const std::size_t count = std::min(kBatch, points_.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      const auto p = mount.undo(points_[begin + i], 1.0F);
      for (std::size_t n = 0; n < 3; ++n) mounted[n][i] = own[n][i] = p[n];
      if (!time_offsets_.empty()) {
        ahead[i] = static_cast<float>(time_offsets_[beam_[begin + i]]);
      }
    }
    for (int round = 0; round < 3; ++round) {
      for (std::size_t i = 0; i < count; ++i) {
        float s = arc_tangent_fast(own[1][i], own[0][i]) * kTurnsPerRadian - zero;
        s = s < -0.5F ? s + 1.0F : s;
        s = s >= 0.5F ? s - 1.0F : s;
        s += ahead[i];
        const auto p = twist.undo({mounted[0][i], mounted[1][i], mounted[2][i]}, s);
        own[0][i] = p[0];
        own[1][i] = p[1];
        own[2][i] = p[2];
        time[i] = s;
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      const float x = own[0][i];
      const float y = own[1][i];
      const float rho = std::sqrt(x * x + y * y);
      const float z = own[2][i] - nod * rho;
      own_[begin + i] = {x, y, z};
      time_[begin + i] = time[i];
      rho_[begin + i] = std::max(0.1F, rho);
      z_[begin + i] = z;
    }
  }
}

void MotionFitter::assign(std::span<const BeamLine> lines) {
  assign_lines({rho_, z_}, lines, beam_);
}

double MotionFitter::height_error(std::size_t i) const {
  const BeamLine& line = lines_[beam_[i]];
  return own_[i][2] - (rho_[i] * line.tan + line.height);
}

// Sideways distance to the nearest tick, metres.
double MotionFitter::aside(std::size_t i, const BeamGeometry& beam, int ticks_per_turn) const {
  const double turn = time_[i] - beam.time_turns + zero_ - lateral_turns(beam, rho_[i]);
  return wrap(turn * ticks_per_turn - beam.phase) / ticks_per_turn * kTwoPi * rho_[i];
}

// One Gauss-Newton step on the heights of the points at most `reach` turns from time 0. Lines that
// are known count where they are far enough apart not to be mistaken for each other.
MotionVector MotionFitter::height_step(bool lines_free, double reach, double scale,
                                       MotionPrior prior, const MotionVector& motion) {
  MotionEquations equations(lines_free ? lines_.size() : 0);
  for (std::size_t i = 0; i < own_.size(); ++i) {
    if (std::abs(time_[i]) > reach) continue;
    // A tilt that is off shows in proportion to the distance.
    const double wide = lines_free ? scale : scale * std::max(1.0, 0.1 * rho_[i]);
    if (!lines_free && gap_[beam_[i]] * rho_[i] < 3.0 * wide) continue;
    const double tan = lines_[beam_[i]].tan;
    const auto& p = own_[i];
    const double rho = rho_[i];
    const double e = height_error(i);
    MotionVector slope = influence(p, time_[i], {-tan * p[0] / rho, -tan * p[1] / rho, 1.0});
    slope[kNod] = -rho;
    if (lines_free) {
      equations.add(beam_[i], robust(e, wide), rho, e, slope);
    } else {
      equations.add(robust(e, wide), e, slope);
    }
  }
  for (const std::size_t about_z : {std::size_t{5}, std::size_t{11}})
    hold(prior, about_z, motion);  // not seen
  MotionVector moved = motion;
  add_to(moved, equations.solve(prior, motion));
  return moved;
}

MotionVector MotionFitter::step_on_lines(double scale, const MotionVector& start,
                                         const MotionVector& motion) {
  assign(lines_);
  refine_lines({rho_, z_}, beam_, scale, lines_);
  MotionPrior prior = prior_unknown(start);
  hold(prior, 8, motion);  // the lines' own heights do for the mount's, their slopes for the nod
  hold(prior, kNod, motion);
  return height_step(true, 1.0, scale, prior, motion);
}

MotionVector MotionFitter::straighten(const SensorModel& model, MotionVector guess, bool outwards) {
  const std::vector<BeamGeometry> beams = beam_geometry(model);
  lines_ = lines_of(beams);
  gap_.assign(lines_.size(), 1.0);
  for (std::size_t k = 1; k < lines_.size(); ++k) {
    const double gap = lines_[k - 1].tan - lines_[k].tan;
    gap_[k - 1] = std::min(gap_[k - 1], gap);
    gap_[k] = std::min(gap_[k], gap);
  }
  const MotionPrior prior = outwards ? prior_unknown(guess) : prior_near(guess);
  MotionVector motion = guess;
  time_offsets_.clear();
  undo(motion);
  assign(lines_);
  for (const BeamGeometry& beam : beams) time_offsets_.push_back(beam.time_turns);
  const auto step = [&](double reach, double scale) {
    motion = height_step(false, reach, scale, prior, motion);
    undo(motion);
    assign(lines_);
  };
  if (outwards) {
    for (const double degrees : {30.0, 45.0, 65.0, 90.0, 120.0, 150.0, 181.0}) {
      step(degrees / 360.0, 0.02);
      step(degrees / 360.0, 0.01);
    }
  }
  for (const double scale :
       {0.04, 0.04, 0.04, 0.025, 0.025, 0.015, 0.015, 0.01, 0.006, 0.004, 0.002}) {
    step(1.0, scale);
  }
  return motion;
}

MotionVector MotionFitter::refine(const SensorModel& model, MotionVector motion) {
  const std::vector<BeamGeometry> beams = beam_geometry(model);
  const MotionPrior prior = prior_near(motion);
  for (const double scale : {0.01, 0.005, 0.003, 0.002, 0.002}) {
    undo(motion);
    assign(lines_);
    MotionEquations equations(0);
    for (std::size_t i = 0; i < own_.size(); ++i) {
      const BeamGeometry& beam = beams[beam_[i]];
      const auto& p = own_[i];
      const double rho = rho_[i];
      const double e = height_error(i);
      const double tan = beam.tan;
      MotionVector slope = influence(p, time_[i], {-tan * p[0] / rho, -tan * p[1] / rho, 1.0});
      slope[kNod] = -rho;
      equations.add(robust(e, scale), e, slope);
      if (rho < 2.0) continue;
      const double a = aside(i, beam, model.ticks_per_turn);
      equations.add(robust(a, scale), a, influence(p, time_[i], {-p[1] / rho, p[0] / rho, 0.0}));
    }
    add_to(motion, equations.solve(prior, motion));
  }
  return motion;
}

void MotionFitter::add_time_offsets(const SensorModel& model, const MotionVector& motion,
                                    std::span<TimeOffsetSums> sums) const {
  constexpr double kScale = 0.003;
  const std::vector<BeamGeometry> beams = beam_geometry(model);
  for (std::size_t i = 0; i < own_.size(); ++i) {
    const std::size_t k = beam_[i];
    const double rho = rho_[i];
    if (rho < 2.0) continue;
    const auto add = [&](double error, const std::array<double, 3>& slope) {
      const MotionVector all = influence(own_[i], 1.0, slope);
      const double speed = std::inner_product(all.begin(), all.begin() + 6, motion.begin(), 0.0);
      const double weight = robust(error, kScale);
      sums[k].square += weight * speed * speed;
      sums[k].product += weight * speed * error;
    };
    const auto& p = own_[i];
    const double tan = beams[k].tan;
    add(height_error(i), {-tan * p[0] / rho, -tan * p[1] / rho, 1.0});
    add(aside(i, beams[k], model.ticks_per_turn), {-p[1] / rho, p[0] / rho, 0.0});
  }
}

Motion estimate_motion(const CloudView& cloud, const SensorModel& model, const Motion* guess) {
  constexpr double kMaxYawChange = 0.03;  // radians a turn, from one sweep to the next
  const std::size_t enough = guess != nullptr ? 4'000 : 40'000;  // points
  const int zero_tick = guess != nullptr ? guess->zero_tick : 0;
  const double zero = static_cast<double>(zero_tick) / model.ticks_per_turn;
  MotionFitter fitter(cloud, std::max<std::size_t>(1, cloud.size / enough), zero);
  Motion still;
  still.mount = model.mount;
  if (fitter.empty()) return guess != nullptr ? *guess : still;
  const MotionVector start = motion_vector(guess != nullptr ? *guess : still);
  MotionVector motion = fitter.straighten(model, start, guess == nullptr);
  const double reach = guess != nullptr ? kMaxYawChange : kMaxYaw;
  fitter.find_yaw(model.ticks_per_turn, &model, start[5], reach, motion);
  return quantised_motion(fitter.refine(model, motion), zero_tick);
}

}  // namespace sweepcast
