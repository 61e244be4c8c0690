#include "lab/simulate/traffic.hpp"

#include <cmath>
#include <utility>

#include "core/trig.hpp"

namespace sweepcast::lab {
namespace {

constexpr double kOncomingSpeed = 9.0;
constexpr double kHeadway = 22.0;  // kept free before and behind the sensor's car

class TrafficBuilder {
 public:
  TrafficBuilder(std::uint64_t seed, const Loop& loop, std::uint16_t first_object)
      : seed_(seed), loop_(loop), next_object_(first_object), random_(seed, 3) {}

  std::vector<Mover> build() {
    for (double s = kHeadway; s < loop_.length() - kHeadway; s += random_.uniform(35.0, 80.0)) {
      Mover car = make(add_car);
      car.start = s;
      car.speed = kSpeed;
      movers_.push_back(std::move(car));
    }
    for (double s = 0.0; s < loop_.length() - 15.0; s += random_.uniform(30.0, 70.0)) {
      Mover car = make(add_car);
      car.start = s;
      car.speed = -kOncomingSpeed;
      car.left = 2.0 * kLane;
      movers_.push_back(std::move(car));
    }
    for (double s = 0.0; s < loop_.length(); s += random_.uniform(8.0, 25.0)) add_walker(s);
    return std::move(movers_);
  }

 private:
  Mover make(Extent (*add)(MeshBuilder, Random&)) {
    Mover mover;
    Random shape(seed_, 4, next_object_);
    MeshBuilder builder{mover.shape};
    builder.surface.object = next_object_++;
    mover.extent = add(builder, shape);
    return mover;
  }

  // On the pavement beside a straight piece of the loop, to either side.
  void add_walker(double s) {
    constexpr double kStretch = 16.0;
    const double bend = loop_.at(s + kStretch).heading - loop_.at(s).heading;
    if (std::abs(bend) > 1e-9) return;
    Mover walker = make(add_pedestrian);
    const double from_kerb = random_.uniform(1.3, 1.9);
    walker.start = s;
    walker.speed = random_.uniform(0.9, 1.6);
    walker.left = random_.chance(0.5) ? -(kCarriageway - kLane) - from_kerb
                                      : kCarriageway + kLane + from_kerb;
    walker.stretch = kStretch;
    walker.lift = kKerbHeight;
    movers_.push_back(std::move(walker));
  }

  std::uint64_t seed_;
  const Loop& loop_;
  std::uint16_t next_object_;
  Random random_;
  std::vector<Mover> movers_;
};

}  // namespace

Pose Mover::at(double seconds, const Loop& loop, const Terrain& terrain) const {
  double run = speed * seconds;
  bool back = speed < 0.0;
  if (stretch > 0.0) {
    run -= 2.0 * stretch * std::floor(run / (2.0 * stretch));
    back = run > stretch;
    if (back) run = 2.0 * stretch - run;
  }
  Loop::Place place = loop.at(start + run, left);
  if (back) place.heading += kPi;
  if (stretch > 0.0) {  // walkers stand upright on a slope, cars do not
    const SinCos heading = sin_cos(place.heading);
    return upright({place.x, place.y, terrain.height(place.x, place.y) + lift}, heading.cos,
                   heading.sin);
  }
  return on_road(terrain, place);
}

std::vector<Mover> build_traffic(std::uint64_t seed, const Loop& loop, std::uint16_t first_object) {
  return TrafficBuilder(seed, loop, first_object).build();
}

}  // namespace sweepcast::lab
