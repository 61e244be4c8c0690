#include <vector>

#include "core/trig.hpp"
#include "lab/simulate/parts.hpp"

namespace sweepcast::lab {
namespace {

// A rectangle with bevelled corners at height z, counter-clockwise from the front right.
std::vector<Vec3> bevelled(double rear, double front, double half_width, double z) {
  constexpr double kBevel = 0.18;
  const double w = half_width;
  return {{front - kBevel, -w, z}, {front, -w + 2.0 * kBevel, z}, {front, w - 2.0 * kBevel, z},
          {front - kBevel, w, z},  {rear + kBevel, w, z},         {rear, w - kBevel, z},
          {rear, -w + kBevel, z},  {rear + kBevel, -w, z}};
}

void add_lid(MeshBuilder& builder, const std::vector<Vec3>& outline) {
  for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
    builder.triangle(outline[0], outline[i], outline[i + 1]);
  }
}

void add_wheel(MeshBuilder builder, double x, double y, double radius) {
  const Pose lying{
      {1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, {0.0, y < 0.0 ? -1.0 : 1.0, 0.0}, {x, y, radius}};
  builder.frame = {builder.frame.rotate(lying.x), builder.frame.rotate(lying.y),
                   builder.frame.rotate(lying.z), builder.frame.apply(lying.origin)};
  builder.surface = {Material::matt, 9, builder.surface.object};
  builder.cone({0.0, 0.0, -0.2}, radius, radius, 0.2, 12);
  builder.surface.albedo = 45;  // rim
  builder.cone({0.0, 0.0, -0.02}, 0.6 * radius, 0.55 * radius, 0.03, 10);
}

}  // namespace

Extent add_car(MeshBuilder builder, Random& random) {
  const bool van = random.chance(0.15);
  const Extent extent{van ? "Van" : "Car",
                      van ? random.uniform(4.7, 5.4) : random.uniform(3.7, 4.7),
                      van ? random.uniform(1.85, 2.0) : random.uniform(1.65, 1.85),
                      van ? random.uniform(1.9, 2.3) : random.uniform(1.42, 1.62)};
  const std::uint16_t object = builder.surface.object;
  constexpr std::uint8_t kColours[] = {8, 14, 25, 40, 60, 70};
  const Surface paint{Material::paint, kColours[random.below(6)], object};
  const double half = 0.5 * extent.length;
  const double width = 0.5 * extent.width;
  const double belt = van ? 1.15 : random.uniform(0.85, 0.95);

  builder.surface = paint;
  const auto sill = bevelled(-half + 0.08, half - 0.08, width - 0.06, 0.22);
  const auto bumper = bevelled(-half, half, width, 0.55);
  const auto shoulder = bevelled(-half + 0.05, half - 0.12, width - 0.03, belt - 0.08);
  builder.band(sill, bumper);
  builder.band(bumper, shoulder);
  const double cabin_rear = van || random.chance(0.5) ? -half + 0.08 : -half + 0.75;
  const double cabin_front = van ? half - 0.75 : 0.22 * extent.length;
  const auto bonnet = bevelled(-half + 0.2, half - 0.35, width - 0.1, belt);
  builder.band(shoulder, bonnet);
  add_lid(builder, bonnet);

  const auto window_low = bevelled(cabin_rear, cabin_front, width - 0.08, belt);
  const double slope = van ? 0.35 : 0.75;
  const auto window_high =
      bevelled(cabin_rear + 0.25, cabin_front - slope, width - 0.22, extent.height - 0.08);
  // Clean panes swallow pulses, dirty or coated ones return many.
  constexpr std::uint8_t kPanes[] = {6, 25, 60};
  const std::uint8_t pane = kPanes[random.below(3)];
  if (!van) builder.surface = {Material::glass, pane, object};
  builder.band(window_low, window_high);
  builder.surface = paint;
  const auto roof =
      bevelled(cabin_rear + 0.4, cabin_front - slope - 0.15, width - 0.3, extent.height);
  builder.band(window_high, roof);
  add_lid(builder, roof);
  builder.surface = {Material::retroreflector, 60, object};  // number plate and lamps
  const double rear = -half;
  builder.quad({rear, -0.26, 0.62}, {rear, 0.26, 0.62}, {rear, 0.26, 0.73}, {rear, -0.26, 0.73});
  builder.surface = paint;
  for (double x : {-half + 0.75, half - 0.8}) {
    for (double y : {0.02 - width, width - 0.02}) add_wheel(builder, x, y, 0.31);
  }
  return extent;
}

Extent add_pedestrian(MeshBuilder builder, Random& random) {
  const double tall = random.uniform(1.55, 1.85);
  const std::uint16_t object = builder.surface.object;
  const auto clothes = [&] {
    return Surface{Material::matt, static_cast<std::uint8_t>(10 + random.below(50)), object};
  };
  builder.surface = clothes();
  builder.cone({0.12, 0.09, 0.0}, 0.07, 0.09, 0.48 * tall, 7);
  builder.cone({-0.12, -0.09, 0.0}, 0.07, 0.09, 0.48 * tall, 7);
  builder.surface = clothes();
  builder.cone({0.0, 0.0, 0.46 * tall}, 0.17, 0.20, 0.37 * tall, 9);
  builder.cone({-0.08, 0.22, 0.45 * tall}, 0.05, 0.06, 0.36 * tall, 6);
  builder.cone({0.08, -0.22, 0.45 * tall}, 0.05, 0.06, 0.36 * tall, 6);
  builder.surface = {Material::matt, 35, object};
  builder.cone({0.0, 0.0, 0.84 * tall}, 0.07, 0.10, 0.10 * tall, 8);
  builder.cone({0.0, 0.0, 0.94 * tall}, 0.10, 0.05, 0.06 * tall, 8);
  return {"Pedestrian", 0.5, 0.56, tall};
}

}  // namespace sweepcast::lab
