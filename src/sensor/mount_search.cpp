#include "sensor/mount_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/trig.hpp"
#include "sensor/motion.hpp"

namespace sweepcast {
namespace {

constexpr double kBin = 0.004;  // of slopes, to begin with

using Point = std::array<float, 3>;

// A small motion away from a start: of the mount x, y, z and its turns about x and y; of the twist
// x, y and the turns about x and y. Metres and radians.
using Nudge = std::array<double, 9>;

// Points in the sensor's frame, as far as known, with their times.
struct TimedPoint {
  Point p;
  float time;
};

class Contrast {
 public:
  explicit Contrast(std::vector<TimedPoint> samples) : samples_(std::move(samples)) {}

  // How sharply slopes gather in bins: the votes' squares over their neighbourhood's mean, a vote.
  // Comparing with the neighbourhood leaves out that some slopes are seen more than others.
  [[nodiscard]] double at(const Nudge& nudge, double bin) {
    votes_.assign(static_cast<std::size_t>(2.0 * kTop / bin) + 3, 0.0F);
    std::array<float, 9> n{};
    std::copy(nudge.begin(), nudge.end(), n.begin());
    const auto per_bin = static_cast<float>(1.0 / bin);
    for (const auto& [q, time] : samples_) {
      const float wx = n[3] + time * n[7];
      const float wy = n[4] + time * n[8];
      const float x = q[0] + n[0] + time * n[5] + wy * q[2];
      const float y = q[1] + n[1] + time * n[6] - wx * q[2];
      const float z = q[2] + n[2] + wx * q[1] - wy * q[0];
      const float slope = z / std::sqrt(x * x + y * y + 0.01F);
      if (!(std::abs(slope) < kTop)) continue;
      const float place = (slope + kTop) * per_bin;
      const auto k = static_cast<std::size_t>(static_cast<std::int32_t>(place));
      const float share = place - static_cast<float>(k);
      votes_[k] += 1.0F - share;
      votes_[k + 1] += share;
    }
    return sharpness(std::max<std::size_t>(3, static_cast<std::size_t>(kReach / bin))) /
           static_cast<double>(samples_.size());
  }

 private:
  static constexpr float kTop = 0.6F;     // of the slopes looked at, either way
  static constexpr double kReach = 0.03;  // of the neighbourhood, in slope, either way

  [[nodiscard]] double sharpness(std::size_t reach) {
    sums_.assign(votes_.size() + 1, 0.0);
    for (std::size_t k = 0; k < votes_.size(); ++k) sums_[k + 1] = sums_[k] + votes_[k];
    double total = 0.0;
    for (std::size_t k = 0; k < votes_.size(); ++k) {
      const std::size_t begin = k < reach ? 0 : k - reach;
      const std::size_t end = std::min(votes_.size(), k + reach + 1);
      const double mean = (sums_[end] - sums_[begin]) / static_cast<double>(end - begin);
      total += votes_[k] * votes_[k] / (mean + 1.0);  // a few votes alone are no beam
    }
    return total;
  }

  std::vector<TimedPoint> samples_;
  std::vector<float> votes_;
  std::vector<double> sums_;
};

// Through a mount; times by azimuth.
std::vector<TimedPoint> sampled(std::span<const Point> points, std::size_t count,
                                const MotionVector& mount, double zero) {
  constexpr double kNear = 4.0;  // metres: nearer ones see the sensor's own vehicle
  const Twist<double> twist(quantised_motion(mount, 0).mount);
  std::vector<TimedPoint> some;
  const std::size_t step = points.size() / count + 1;
  for (std::size_t i = 0; i < points.size(); i += step) {
    const auto p = twist.undo({points[i][0], points[i][1], points[i][2]}, 1.0);
    if (p[0] * p[0] + p[1] * p[1] < kNear * kNear) continue;
    const double time = arc_tangent(p[1], p[0]) / (2.0 * kPi) - zero;
    some.push_back({{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])},
                    static_cast<float>(wrap(time))});
  }
  return some;
}

struct Candidate {
  double contrast = 0.0;
  Nudge nudge{};
};

// Height and tilts on a grid, in the middle of the frame; the best first.
std::vector<Candidate> coarse(std::span<const Point> points, double bin) {
  constexpr double kTilt = 5.0 * kDegree;
  constexpr int kTilts = 12;  // either way
  Contrast contrast(sampled(points, 3000, {}, 0.0));
  std::vector<Candidate> all;
  for (int h = -15; h <= 5; ++h) {
    for (int a = -kTilts; a <= kTilts; ++a) {
      for (int b = -kTilts; b <= kTilts; ++b) {
        const Nudge nudge{0.0, 0.0, 0.2 * h, a * kTilt / kTilts, b * kTilt / kTilts};
        all.push_back({contrast.at(nudge, bin), nudge});
      }
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Candidate& a, const Candidate& b) { return a.contrast > b.contrast; });
  return all;
}

// Goes uphill in ever smaller steps: one number at a time, and those pairs that make up for each
// other, as moving aside and tilting do.
void climb(Contrast& contrast, double bin, bool with_twist, Candidate& best) {
  struct Move {
    int first, second;
  };
  constexpr std::array<Move, 17> kMoves{{{0, -1},
                                         {1, -1},
                                         {2, -1},
                                         {3, -1},
                                         {4, -1},
                                         {0, 4},
                                         {1, 3},
                                         {2, 3},
                                         {2, 4},
                                         {5, -1},
                                         {6, -1},
                                         {7, -1},
                                         {8, -1},
                                         {5, 8},
                                         {6, 7},
                                         {0, 5},
                                         {1, 6}}};
  constexpr std::size_t kOfTheMount = 9;  // moves
  constexpr Nudge kFarthest{2.0, 2.0, 4.0, 0.2, 0.2, 3.0, 3.0, 0.1, 0.1};
  best.contrast = contrast.at(best.nudge, bin);
  Nudge step{100.0, 100.0, 50.0, 2.0, 2.0, 100.0, 100.0, 2.0, 2.0};
  for (double& s : step) s *= bin;
  int halvings = 0;
  for (int round = 0; round < 40 && halvings < 4; ++round) {
    const double before = best.contrast;
    const auto attempt = [&](Move move, double by, double and_by) {
      Nudge nudge = best.nudge;
      bool inside = true;
      const auto shift = [&](int number, double steps) {
        const auto i = static_cast<std::size_t>(number);
        nudge[i] += steps * step[i];
        inside = inside && std::abs(nudge[i]) <= kFarthest[i];
      };
      shift(move.first, by);
      if (move.second >= 0) shift(move.second, and_by);
      if (!inside) return;
      if (const double here = contrast.at(nudge, bin); here > best.contrast) best = {here, nudge};
    };
    for (std::size_t m = 0; m < (with_twist ? kMoves.size() : kOfTheMount); ++m) {
      for (const double by : {-1.0, 1.0}) {
        attempt(kMoves[m], by, 1.0);
        if (kMoves[m].second >= 0) attempt(kMoves[m], by, -1.0);
      }
    }
    if (best.contrast > before) continue;
    for (double& s : step) s *= 0.5;
    ++halvings;
  }
}

// The nudge that brought p = R q + t to p + dt + dr x p, as numbers of a motion.
MotionVector nudged(MotionVector motion, const Nudge& by) {
  const double rx = by[3];
  const double ry = by[4];
  const double x = motion[6];
  const double y = motion[7];
  const double z = motion[8];
  motion[6] = x + by[0] + ry * z;
  motion[7] = y + by[1] - rx * z;
  motion[8] = z + by[2] + rx * y - ry * x;
  motion[9] += rx;  // turns are small: their order does not matter here
  motion[10] += ry;
  motion[0] += by[5];
  motion[1] += by[6];
  motion[3] += by[7];
  motion[4] += by[8];
  return motion;
}

}  // namespace

MotionVector search_mount(std::span<const std::array<float, 3>> points) {
  constexpr std::size_t kStarts = 12;
  std::vector<Candidate> starts = coarse(points, kBin);
  starts.resize(kStarts);
  Contrast contrast(sampled(points, 5000, {}, 0.0));
  Candidate best;
  for (Candidate& start : starts) {
    climb(contrast, kBin, false, start);
    if (start.contrast > best.contrast) best = start;
  }
  climb(contrast, kBin / 2, false, best);
  return nudged({}, best.nudge);
}

double search_twist(std::span<const std::array<float, 3>> points, double zero,
                    MotionVector& motion) {
  Contrast contrast(sampled(points, 5000, motion, zero));
  Candidate best;
  for (const double bin : {kBin, kBin / 2, kBin / 4}) climb(contrast, bin, true, best);
  motion = nudged(motion, best.nudge);
  return best.contrast;
}

}  // namespace sweepcast
