#include <algorithm>
#include <vector>

#include "core/trig.hpp"
#include "lab/simulate/parts.hpp"

namespace sweepcast::lab {
namespace {

constexpr double kStorey = 3.1;

// What repeats on one facade.
struct Style {
  double bay = 3.0;  // width of a facade unit
  double window_width = 1.3;
  double window_height = 1.5;
  double sill = 0.9;
  double recess = 0.18;  // windows lie this deep in the wall
  bool shop = false;     // wide panes on the ground floor
  bool balconies = false;
  std::uint8_t albedo = 40;
};

Style pick_style(Random& random) {
  constexpr std::uint8_t kWalls[] = {28, 34, 40, 46, 52};
  Style style;
  style.bay = random.uniform(2.6, 3.6);
  style.window_width = random.uniform(0.9, 1.5);
  style.window_height = random.uniform(1.2, 1.7);
  style.recess = random.uniform(0.10, 0.28);
  style.shop = random.chance(0.3);
  style.balconies = random.chance(0.25);
  style.albedo = kWalls[random.below(5)];
  return style;
}

// One facade unit: a wall from (x0, z0) to (x1, z1) with a hole from (a, c) to (b, d) that is
// closed `depth` metres behind it by `fill`.
struct Bay {
  double x0, x1, z0, z1;
  double a, b, c, d;
  double depth;
  Surface fill;
};

void add_bay(MeshBuilder& builder, const Bay& bay, Surface wall) {
  const auto pane = [&](double xa, double xb, double za, double zb) {
    if (xb > xa && zb > za) builder.quad({xa, 0, za}, {xb, 0, za}, {xb, 0, zb}, {xa, 0, zb});
  };
  builder.surface = wall;
  pane(bay.x0, bay.a, bay.z0, bay.z1);
  pane(bay.b, bay.x1, bay.z0, bay.z1);
  pane(bay.a, bay.b, bay.z0, bay.c);
  pane(bay.a, bay.b, bay.d, bay.z1);
  const double y = bay.depth;
  const std::vector<Vec3> rim{
      {bay.a, 0, bay.c}, {bay.b, 0, bay.c}, {bay.b, 0, bay.d}, {bay.a, 0, bay.d}};
  std::vector<Vec3> back = rim;
  for (Vec3& p : back) p.y = y;
  builder.band(rim, back);
  builder.surface = bay.fill;
  builder.quad(back[0], back[1], back[2], back[3]);
  if (bay.fill.material != Material::glass) return;
  // Frame: what a beam sees of most windows.
  builder.surface = {Material::matt, 65, 0};
  const double middle = 0.5 * (bay.a + bay.b);
  const double low = bay.c + 0.02;
  builder.box({middle - 0.04, y - 0.05, low}, {middle + 0.04, y, bay.d});
  builder.box({bay.a, y - 0.05, low}, {bay.a + 0.07, y, bay.d});
  builder.box({bay.b - 0.07, y - 0.05, low}, {bay.b, y, bay.d});
  const double transom = bay.c + 0.65 * (bay.d - bay.c);
  builder.box({bay.a, y - 0.05, transom}, {bay.b, y, transom + 0.06});
  builder.box({bay.a - 0.06, -0.07, bay.c - 0.07}, {bay.b + 0.06, y, bay.c});  // sill
}

void add_balcony(MeshBuilder& builder, double x0, double x1, double z) {
  builder.surface = {Material::matt, 42, 0};
  builder.box({x0, -1.1, z - 0.15}, {x1, 0.0, z});
  builder.surface = {Material::matt, 25, 0};
  builder.box({x0, -1.1, z + 0.95}, {x1, -1.05, z + 1.0});
  for (double x = x0; x < x1; x += 0.14) builder.box({x, -1.09, z}, {x + 0.02, -1.06, z + 0.95});
}

// What one bay of one storey holds: a door, a shop's pane or a window.
Bay plan_bay(const Style& style, int storey, bool door, double x0, double x1, double z0,
             Random& random) {
  const double middle = 0.5 * (x0 + x1);
  Bay bay{x0, x1, z0, z0 + kStorey, 0, 0, 0, 0, style.recess, {Material::glass, 85, 0}};
  double half = std::min(0.5 * style.window_width, 0.5 * (x1 - x0) - 0.2);
  bay.c = z0 + style.sill;
  bay.d = bay.c + style.window_height;
  if (storey == 0 && door) {
    half = 0.55;
    bay.c = z0;
    bay.d = z0 + 2.25;
    bay.depth = style.recess + 0.2;
    bay.fill = {Material::matt, static_cast<std::uint8_t>(15 + random.below(30)), 0};
  } else if (storey == 0 && style.shop) {
    half = 0.5 * (x1 - x0) - 0.25;
    bay.c = z0 + 0.45;
    bay.d = z0 + 2.6;
  } else if (random.chance(0.35)) {  // shutters down, curtains drawn
    bay.fill = {Material::matt, 55, 0};
  }
  bay.a = middle - half;
  bay.b = middle + half;
  return bay;
}

// A street front from x = 0 to width, with openings.
void add_facade(MeshBuilder builder, double width, int storeys, const Style& style,
                Random& random) {
  const Surface wall{Material::matt, style.albedo, 0};
  const int bays = std::max(1, static_cast<int>(width / style.bay));
  const double step = width / bays;
  const int door = random.below(bays);
  for (int storey = 0; storey < storeys; ++storey) {
    for (int i = 0; i < bays; ++i) {
      const Bay bay =
          plan_bay(style, storey, i == door, i * step, (i + 1) * step, storey * kStorey, random);
      add_bay(builder, bay, wall);
      if (style.balconies && storey > 0 && random.chance(0.5)) {
        add_balcony(builder, i * step + 0.3, (i + 1) * step - 0.3, storey * kStorey);
      }
    }
    if (storey == 0) {  // string course
      builder.surface = wall;
      builder.box({0.0, -0.08, kStorey - 0.12}, {width, 0.0, kStorey});
    }
  }
  builder.surface = {Material::matt, 50, 0};
  builder.box({door * step + 0.5 * step - 0.8, -0.45, -0.8},
              {door * step + 0.5 * step + 0.8, 0, 0});
  builder.cone({width - 0.15, -0.08, -0.2}, 0.05, 0.05, storeys * kStorey, 6);  // drainpipe
  if (style.shop && random.chance(0.5)) {                                       // awning
    builder.surface = {Material::matt, 35, 0};
    builder.quad({0.3, 0.0, 2.95}, {width - 0.3, 0.0, 2.95}, {width - 0.3, -1.3, 2.45},
                 {0.3, -1.3, 2.45});
  }
}

void add_wall(MeshBuilder& builder, Vec3 from, Vec3 to, double low, double high) {
  builder.quad({from.x, from.y, low}, {to.x, to.y, low}, {to.x, to.y, high},
               {from.x, from.y, high});
}

void add_roof(MeshBuilder& builder, const std::vector<Vec3>& outline, const House& house,
              double eaves) {
  builder.surface = {Material::matt, 22, 0};
  if (house.chamfer > 0.0 || !house.detailed) {
    for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
      const auto lifted = [&](std::size_t at) { return outline[at] + Vec3{0, 0, eaves}; };
      builder.triangle(lifted(0), lifted(i), lifted(i + 1));
    }
    return;
  }
  const double ridge = eaves + 0.35 * house.depth;
  const Vec3 a{0, 0.5 * house.depth, ridge};
  const Vec3 b{house.width, 0.5 * house.depth, ridge};
  builder.quad({-0.1, -0.4, eaves - 0.1}, {house.width + 0.1, -0.4, eaves - 0.1}, b, a);
  builder.quad({0, house.depth, eaves}, {house.width, house.depth, eaves}, b, a);
  builder.triangle({0, 0, eaves}, {0, house.depth, eaves}, a);
  builder.triangle({house.width, 0, eaves}, {house.width, house.depth, eaves}, b);
}

}  // namespace

void add_house(MeshBuilder builder, const House& house, Random& random) {
  const Style style = pick_style(random);
  const double cut = house.chamfer;
  std::vector<Vec3> outline{{0, 0, 0}, {house.width - cut, 0, 0}};
  if (cut > 0.0) outline.push_back({house.width, cut, 0});
  outline.push_back({house.width, house.depth, 0});
  outline.push_back({0, house.depth, 0});
  const double eaves = house.storeys * kStorey;
  // Fronts look at a street: the first edge, and at a corner the two that follow.
  const std::size_t fronts = cut > 0.0 ? 3 : 1;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec3 from = outline[i];
    const Vec3 to = outline[(i + 1) % outline.size()];
    const bool front = house.detailed && i < fronts;
    builder.surface = {Material::matt, style.albedo, 0};
    add_wall(builder, from, to, -house.footing, front ? 0.0 : eaves);
    if (!front) continue;
    const double width = length(to - from);
    const Vec3 along = (to - from) * (1.0 / width);
    MeshBuilder facade = builder;
    const Vec3 x = builder.frame.rotate(along);
    facade.frame = {x, cross(builder.frame.z, x), builder.frame.z, builder.frame.apply(from)};
    add_facade(facade, width, house.storeys, style, random);
  }
  add_roof(builder, outline, house, eaves);
}

void add_fence(MeshBuilder builder, double width, Random& random) {
  builder.surface = {Material::matt, static_cast<std::uint8_t>(28 + random.below(20)), 0};
  if (random.chance(0.5)) {
    builder.box({0.0, 0.0, -0.5}, {width, 0.25, random.uniform(0.8, 1.8)});
    return;
  }
  builder.box({0.0, 0.0, -0.5}, {width, 0.25, 0.35});
  builder.box({0.0, 0.1, 1.15}, {width, 0.14, 1.2});
  for (double x = 0.0; x < width; x += 0.13) builder.box({x, 0.11, 0.3}, {x + 0.025, 0.135, 1.15});
}

}  // namespace sweepcast::lab
