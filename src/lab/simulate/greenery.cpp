#include "core/trig.hpp"
#include "lab/simulate/parts.hpp"

namespace sweepcast::lab {
namespace {

// A point in the unit ball, by rejection.
Vec3 in_ball(Random& random) {
  for (;;) {
    const Vec3 p{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
    if (dot(p, p) <= 1.0) return p;
  }
}

void add_leaf(MeshBuilder& builder, Vec3 middle, double size, Random& random) {
  const Vec3 a = in_ball(random) * size;
  const Vec3 b = in_ball(random) * size;
  builder.surface.albedo = static_cast<std::uint8_t>(38 + random.below(18));
  builder.triangle(middle + a, middle + b, middle - (a + b));
}

// Leaves in an ellipsoid, denser towards its skin, in clumps as twigs hold them.
void add_crown(MeshBuilder& builder, Vec3 middle, Vec3 radii, int leaves, double size,
               Random& random) {
  builder.surface = {Material::foliage, 45, 0};
  constexpr int kTwig = 8;
  for (int i = 0; i < leaves; i += kTwig) {
    Vec3 p = in_ball(random);
    p = p * (0.45 + 0.55 / (0.4 + dot(p, p)) * 0.9);
    const Vec3 twig = middle + Vec3{p.x * radii.x, p.y * radii.y, p.z * radii.z};
    for (int j = 0; j < kTwig; ++j) {
      add_leaf(builder, twig + in_ball(random) * (2.5 * size), size, random);
    }
  }
}

}  // namespace

void add_tree(MeshBuilder builder, Random& random) {
  const double trunk = random.uniform(2.2, 3.4);
  const double girth = random.uniform(0.10, 0.22);
  const double spread = random.uniform(1.4, 2.6);
  const double tall = random.uniform(1.5, 3.0);
  builder.surface = {Material::matt, 33, 0};
  const Vec3 lean{random.uniform(-0.15, 0.15), random.uniform(-0.15, 0.15), 0.0};
  builder.cone({0.0, 0.0, -0.2}, girth * 1.25, girth, 0.6, 8);
  builder.cone(lean * 0.0 + Vec3{0.0, 0.0, 0.4}, girth, girth * 0.75, trunk + 0.8, 8);
  for (int i = 0; i < 5; ++i) {  // boughs: slanted blades of two triangles each
    const SinCos angle = sin_cos(2.0 * kPi * (i + random.uniform()) / 5.0);
    const Vec3 from{lean.x * 0.3, lean.y * 0.3, trunk - 0.3 + 0.2 * i};
    const Vec3 to{spread * 0.7 * angle.cos, spread * 0.7 * angle.sin, trunk + 0.4 * tall + 0.2 * i};
    const Vec3 side{-0.05 * angle.sin, 0.05 * angle.cos, 0.0};
    builder.triangle(from - side, from + side, to);
    builder.triangle(from - Vec3{0.0, 0.0, 0.06}, from + Vec3{0.0, 0.0, 0.06}, to);
  }
  add_crown(builder, Vec3{lean.x, lean.y, trunk + tall}, {spread, spread, tall}, 640, 0.17, random);
}

void add_hedge(MeshBuilder builder, double width, Random& random) {
  const double height = random.uniform(0.9, 1.8);
  // A core, since nothing shines through a dense hedge, in a coat of leaves.
  builder.surface = {Material::foliage, 35, 0};
  builder.box({0.0, 0.15, -0.3}, {width, 0.65, height - 0.12});
  const int leaves = static_cast<int>(width * 70.0);
  for (int i = 0; i < leaves; ++i) {
    const bool top = random.chance(0.3);
    const Vec3 p{random.uniform(0.0, width), random.uniform(0.0, top ? 0.8 : 0.2),
                 top ? height - random.uniform(0.0, 0.12) : random.uniform(0.0, height)};
    add_leaf(builder, p, 0.10, random);
  }
}

void add_bush(MeshBuilder builder, Random& random) {
  const double radius = random.uniform(0.5, 1.1);
  add_crown(builder, {0.0, 0.0, 0.7 * radius}, {radius, radius, 0.9 * radius}, 240, 0.11, random);
}

}  // namespace sweepcast::lab
