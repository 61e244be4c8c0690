#include "lab/simulate/road.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/trig.hpp"

namespace sweepcast::lab {
namespace {

constexpr double kTurnRadius = 18.0;
constexpr double kRamp = 8.0;  // over which the wheel is turned in, and back
constexpr double kArc = kTurnRadius * kPi / 2.0 - kRamp;
constexpr double kStep = 0.05;

// Heading after `run` metres of a left corner: curvature rises, holds, falls (a clothoid, an arc,
// a clothoid), and the whole turns by 90 degrees.
double corner_heading(double run) {
  const double ramp_turn = kRamp / (2.0 * kTurnRadius);
  if (run < kRamp) return run * run / (2.0 * kRamp * kTurnRadius);
  if (run < kRamp + kArc) return ramp_turn + (run - kRamp) / kTurnRadius;
  const double rest = kArc + 2.0 * kRamp - run;
  return kPi / 2.0 - rest * rest / (2.0 * kRamp * kTurnRadius);
}

// Metres to the middle of the nearest of the streets that cross this axis, at most to its kerb.
double to_crown(double value) {
  const double pitches = value / kPitch;
  return std::min(std::abs(pitches - std::floor(pitches + 0.5)) * kPitch, kCarriageway);
}

constexpr double kCornerRun = kArc + 2.0 * kRamp;
const int kCornerSteps = static_cast<int>(kCornerRun / kStep);

// How far a corner reaches along its first street, from its begin to the streets' crossing: by
// the corner's symmetry as far as it goes sideways.
double corner_reach() {
  const double step = kCornerRun / kCornerSteps;
  double forward = 0.0;
  for (int i = 0; i < kCornerSteps; ++i) {
    forward += step * sin_cos(corner_heading((i + 0.5) * step)).cos;
  }
  return forward;
}

}  // namespace

Terrain::Terrain(Random random) : phase_{} {
  for (double& phase : phase_) phase = random.uniform(0.0, 2.0 * kPi);
}

double Terrain::height(double x, double y) const {
  constexpr double kTurn = 2.0 * kPi;
  const double camber = -0.02 * (to_crown(x) + to_crown(y));
  return camber + 1.3 * sin_cos(kTurn * x / 230.0 + phase_[0]).sin +
         1.0 * sin_cos(kTurn * y / 190.0 + phase_[1]).sin +
         0.3 * sin_cos(kTurn * (x + y) / 110.0 + phase_[2]).sin;
}

Loop::Loop(int blocks) {
  // Streets between corners, in pitches, and whether the corner after each turns left.
  struct Leg {
    double pitches;
    bool left;
  };
  const std::vector<Leg> legs =
      blocks == 1
          ? std::vector<Leg>{{1, true}, {1, true}, {1, true}, {1, true}}
          : std::vector<Leg>{{2, true}, {1, true}, {1, false}, {1, true}, {1, true}, {2, true}};
  const double reach = corner_reach();
  places_.push_back({reach - kLane, -kLane, 0.0});  // just out of the last corner, a left one
  distance_.push_back(0.0);
  bool left_before = legs.back().left;
  for (const Leg& leg : legs) {
    // The right lane is longer round a left corner, shorter round a right one.
    const double lanes = (left_before ? kLane : -kLane) + (leg.left ? kLane : -kLane);
    add_straight(leg.pitches * kPitch + lanes - 2.0 * reach);
    add_corner(leg.left ? 1.0 : -1.0);
    left_before = leg.left;
  }
}

void Loop::add(double step, double heading) {
  const Place& last = places_.back();
  const SinCos middle = sin_cos(0.5 * (last.heading + heading));
  places_.push_back({last.x + step * middle.cos, last.y + step * middle.sin, heading});
  distance_.push_back(distance_.back() + step);
}

void Loop::add_straight(double run) {
  add(run, places_.back().heading);
}

void Loop::add_corner(double sign) {
  const double heading = places_.back().heading;
  const double step = kCornerRun / kCornerSteps;
  for (int i = 1; i <= kCornerSteps; ++i) add(step, heading + sign * corner_heading(i * step));
}

Loop::Place Loop::at(double distance, double left) const {
  double run = std::fmod(distance, length());
  if (run < 0.0) run += length();
  const auto after = std::upper_bound(distance_.begin() + 1, distance_.end() - 1, run);
  const auto i = static_cast<std::size_t>(after - distance_.begin());
  const double part = (run - distance_[i - 1]) / (distance_[i] - distance_[i - 1]);
  const Place& a = places_[i - 1];
  const Place& b = places_[i];
  Place place{a.x + part * (b.x - a.x), a.y + part * (b.y - a.y),
              a.heading + part * (b.heading - a.heading)};
  const SinCos heading = sin_cos(place.heading);
  place.x -= left * heading.sin;
  place.y += left * heading.cos;
  return place;
}

Pose on_road(const Terrain& terrain, const Loop::Place& place) {
  constexpr double kAxles = 1.35;
  constexpr double kTrack = 0.8;
  const SinCos heading = sin_cos(place.heading);
  const auto ground = [&](double forward, double left) {
    const double x = place.x + forward * heading.cos - left * heading.sin;
    const double y = place.y + forward * heading.sin + left * heading.cos;
    return Vec3{x, y, terrain.height(x, y)};
  };
  const Vec3 front = ground(kAxles, 0.0);
  const Vec3 rear = ground(-kAxles, 0.0);
  const Vec3 across = ground(0.0, kTrack) - ground(0.0, -kTrack);
  Pose pose;
  pose.x = normalized(front - rear);
  pose.z = normalized(cross(pose.x, across));
  pose.y = cross(pose.z, pose.x);
  pose.origin = (front + rear) * 0.5;
  return pose;
}

}  // namespace sweepcast::lab
