// The lie of the land, the street plan and the loop that the car drives.
#pragma once

#include <vector>

#include "lab/random.hpp"
#include "lab/simulate/geometry.hpp"

namespace sweepcast::lab {

// The street plan, metres. Streets run along x = i * kPitch and y = j * kPitch.
inline constexpr double kPitch = 80.0;
inline constexpr double kLane = 1.65;        ///< from a street's middle to a lane's middle
inline constexpr double kCarriageway = 5.5;  ///< from a street's middle to the kerb
inline constexpr double kKerbHeight = 0.12;
inline constexpr double kBlockHalf = 0.5 * kPitch - kCarriageway;  ///< block's middle to the kerb
inline constexpr double kCornerRadius = 10.0;                      ///< of the kerb at a crossing
inline constexpr int kFirstBlock = -2;  ///< blocks run from here to kLastBlock, both ways
inline constexpr int kLastBlock = 3;

/// Height of the road surface: gentle hills, slopes up to about 6 %, and a camber of 2 % from the
/// middle of a street to its kerbs.
class Terrain {
 public:
  explicit Terrain(Random random);
  [[nodiscard]] double height(double x, double y) const;

 private:
  double phase_[3];
};

/// A closed loop of streets, in the right lane, round corners that begin and end gradually.
class Loop {
 public:
  /// `blocks` 1: round one block, about 290 m. 3: round three blocks in an L, about 600 m, with
  /// five left turns and a right one.
  explicit Loop(int blocks);

  struct Place {
    double x = 0.0;
    double y = 0.0;
    double heading = 0.0;  ///< radians from the x axis, counter-clockwise
  };
  /// The place `distance` metres along the loop, any sign, and `left` metres beside it.
  [[nodiscard]] Place at(double distance, double left = 0.0) const;
  [[nodiscard]] double length() const { return distance_.back(); }

 private:
  void add_straight(double run);
  void add_corner(double sign);
  void add(double step, double heading);

  std::vector<double> distance_;
  std::vector<Place> places_;
};

/// The frame of a car that stands on the road at `place`: x forward, y left, z up, pitch and roll
/// as the slope under its wheels gives them, the origin on the ground.
[[nodiscard]] Pose on_road(const Terrain& terrain, const Loop::Place& place);

}  // namespace sweepcast::lab
