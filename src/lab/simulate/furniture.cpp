#include "core/trig.hpp"
#include "lab/simulate/parts.hpp"

namespace sweepcast::lab {
namespace {

// A vertical plate of 3, 4 or 8 corners, 4 cm thick, that faces -x.
void add_plate(MeshBuilder& builder, double z, double radius, int corners) {
  const Surface face{Material::retroreflector, 90, 0};
  std::vector<Vec3> front;
  std::vector<Vec3> back;
  for (int i = 0; i < corners; ++i) {
    const SinCos angle = sin_cos(2.0 * kPi * (i + 0.5) / corners + kPi / 2.0);
    front.push_back({-0.06, radius * angle.cos, z + radius * angle.sin});
    back.push_back({-0.02, radius * angle.cos, z + radius * angle.sin});
  }
  builder.surface = face;
  for (std::size_t i = 1; i + 1 < front.size(); ++i) {
    builder.triangle(front[0], front[i], front[i + 1]);
  }
  builder.surface = {Material::matt, 35, 0};
  builder.band(front, back);
  for (std::size_t i = 1; i + 1 < back.size(); ++i) builder.triangle(back[0], back[i], back[i + 1]);
}

}  // namespace

void add_lamp(MeshBuilder builder, Random& random) {
  const double height = random.uniform(5.5, 7.5);
  builder.surface = {Material::matt, 45, 0};
  builder.cone({0.0, 0.0, -0.2}, 0.13, 0.11, 1.3, 10);
  builder.cone({0.0, 0.0, 1.1}, 0.08, 0.055, height - 1.1, 10);
  builder.box({-0.04, -1.6, height - 0.08}, {0.04, 0.0, height});
  builder.box({-0.15, -2.1, height - 0.14}, {0.15, -1.4, height});
}

void add_sign(MeshBuilder builder, Random& random) {
  const double height = random.uniform(2.2, 2.8);
  builder.surface = {Material::matt, 50, 0};
  builder.cone({0.0, 0.0, -0.2}, 0.035, 0.035, height + 0.6, 8);
  constexpr int kShapes[] = {3, 4, 8, 8};
  const double radius = random.uniform(0.3, 0.4);
  add_plate(builder, height, radius, kShapes[random.below(4)]);
  if (random.chance(0.3)) add_plate(builder, height - 0.75, 0.25, 4);
}

void add_traffic_light(MeshBuilder builder) {
  builder.surface = {Material::matt, 25, 0};
  builder.cone({0.0, 0.0, -0.2}, 0.07, 0.06, 3.4, 8);
  builder.box({-0.18, -0.16, 2.2}, {0.06, 0.16, 3.1});
  builder.box({-0.14, -0.22, 2.1}, {-0.1, 0.22, 3.2});
}

void add_bollard(MeshBuilder builder) {
  builder.surface = {Material::matt, 30, 0};
  builder.cone({0.0, 0.0, -0.1}, 0.06, 0.06, 1.0, 8);
  builder.surface = {Material::retroreflector, 70, 0};
  builder.cone({0.0, 0.0, 0.75}, 0.065, 0.065, 0.1, 8);
}

void add_furniture(MeshBuilder builder, Random& random) {
  switch (random.below(4)) {
    case 0:  // bin
      builder.surface = {Material::matt, 18, 0};
      builder.cone({0.0, 0.0, -0.1}, 0.24, 0.28, 1.0, 10);
      break;
    case 1:  // cabinet
      builder.surface = {Material::matt, 40, 0};
      builder.box({-0.6, -0.2, -0.1}, {0.6, 0.2, 1.3});
      break;
    case 2:  // bench
      builder.surface = {Material::matt, 28, 0};
      builder.box({-0.8, -0.2, 0.42}, {0.8, 0.2, 0.48});
      builder.box({-0.8, 0.2, 0.45}, {0.8, 0.25, 0.9});
      builder.box({-0.7, -0.15, -0.1}, {-0.6, 0.2, 0.42});
      builder.box({0.6, -0.15, -0.1}, {0.7, 0.2, 0.42});
      break;
    default:  // stand for bicycles: five hoops
      builder.surface = {Material::matt, 55, 0};
      for (int i = 0; i < 5; ++i) {
        const double x = 0.6 * i;
        builder.box({x - 0.025, -0.35, -0.1}, {x + 0.025, -0.3, 0.8});
        builder.box({x - 0.025, 0.3, -0.1}, {x + 0.025, 0.35, 0.8});
        builder.box({x - 0.025, -0.3, 0.75}, {x + 0.025, 0.3, 0.8});
      }
  }
}

}  // namespace sweepcast::lab
