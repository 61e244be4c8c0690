#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/trig.hpp"
#include "lab/simulate/parts.hpp"

namespace sweepcast::lab {
namespace {

constexpr double kCell = 2.0;
constexpr double kPavement = 3.0;
constexpr double kMargin = 60.0;  // of road surface beyond the outermost streets

// Points counter-clockwise round a square with rounded corners, `inset` metres inside the kerb.
std::vector<Vec3> outline(double inset) {
  constexpr int kCornerPoints = 8;
  constexpr int kSidePoints = 22;
  const double half = kBlockHalf - inset;
  const double radius = std::max(kCornerRadius - inset, 0.5);
  std::vector<Vec3> points;
  for (int side = 0; side < 4; ++side) {
    const SinCos turn = sin_cos(side * kPi / 2.0);
    const auto add = [&](double x, double y) {
      points.push_back({x * turn.cos - y * turn.sin, x * turn.sin + y * turn.cos, 0.0});
    };
    const double straight = half - radius;
    for (int i = 0; i < kSidePoints; ++i) {
      add(half, straight * (2.0 * i / kSidePoints - 1.0));
    }
    for (int i = 0; i < kCornerPoints; ++i) {
      const SinCos angle = sin_cos(kPi / 2.0 * i / kCornerPoints);
      add(straight + radius * angle.cos, straight + radius * angle.sin);
    }
  }
  return points;
}

// Whether a square cell lies under a block, out of sight.
bool under_block(double x, double y) {
  const auto to_street = [](double value) {
    const double part = value / kPitch - std::floor(value / kPitch);
    return std::min(part, 1.0 - part) * kPitch;
  };
  const double hidden = kCarriageway + kCornerRadius;
  return to_street(x + 0.5 * kCell) > hidden && to_street(y + 0.5 * kCell) > hidden;
}

}  // namespace

void add_carriageways(MeshBuilder builder, const Terrain& terrain) {
  builder.surface = {Material::matt, 26, 0};
  const double low = kFirstBlock * kPitch - kMargin;
  const double high = (kLastBlock + 1) * kPitch + kMargin;
  const int count = static_cast<int>((high - low) / kCell);
  const auto row = static_cast<std::uint32_t>(count + 1);
  const auto first = static_cast<std::uint32_t>(builder.mesh.vertices.size());
  for (int j = 0; j <= count; ++j) {
    for (int i = 0; i <= count; ++i) {
      const double x = low + i * kCell;
      const double y = low + j * kCell;
      builder.vertex({x, y, terrain.height(x, y)});
    }
  }
  Random patches(7);
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < count; ++i) {
      if (under_block(low + i * kCell, low + j * kCell)) continue;
      builder.surface.albedo = static_cast<std::uint8_t>(24 + patches.below(6));
      const std::uint32_t a =
          first + static_cast<std::uint32_t>(j) * row + static_cast<std::uint32_t>(i);
      builder.face(a, a + 1, a + row + 1);
      builder.face(a, a + row + 1, a + row);
    }
  }
}

void add_block_ground(MeshBuilder builder, const Terrain& terrain, double x, double y,
                      Random& random) {
  const auto ring = [&](double inset, double lift, double roughness) {
    std::vector<Vec3> points = outline(inset);
    for (Vec3& p : points) {
      p = {p.x + x, p.y + y, 0.0};
      p.z = terrain.height(p.x, p.y) + lift + roughness * random.uniform(-1.0, 1.0);
    }
    return points;
  };
  std::vector<Vec3> outer = ring(0.0, kKerbHeight, 0.0);
  builder.surface = {Material::matt, 38, 0};
  builder.band(ring(0.0, -0.2, 0.0), outer);
  const auto grow = [&](double inset, double roughness) {
    std::vector<Vec3> inner = ring(inset, kKerbHeight, roughness);
    builder.band(outer, inner);
    outer = std::move(inner);
  };
  grow(0.2, 0.0);
  builder.surface.albedo = 31;
  grow(1.6, 0.0);
  grow(kPavement, 0.0);
  builder.surface = {Material::matt, 42, 0};  // grass
  for (double inset = kPavement + 1.0; inset < kBlockHalf - 1.0; inset += 1.5) grow(inset, 0.04);
  builder.band(outer, std::vector<Vec3>(outer.size(), {x, y, terrain.height(x, y) + kKerbHeight}));
}

void add_markings(MeshBuilder builder, const Terrain& terrain, double x, double y, bool along_x) {
  constexpr double kPaint = 0.006;
  builder.surface = {Material::matt, 75, 0};
  const auto stripe = [&](double from, double to, double left, double right) {
    const auto corner = [&](double along, double across) {
      Vec3 p{x + (along_x ? along : across), y + (along_x ? across : along), 0.0};
      p.z = terrain.height(p.x, p.y) + kPaint;
      return p;
    };
    builder.quad(corner(from, left), corner(to, left), corner(to, right), corner(from, right));
  };
  const double clear = kCarriageway + kCornerRadius + 2.0;
  for (double at = clear; at + 2.0 < kPitch - clear; at += 5.0) stripe(at, at + 2.0, -0.07, 0.07);
  for (double end : {clear - 6.0, kPitch - clear + 2.5}) {
    for (double across = -5.0; across < 5.0; across += 1.0) {
      stripe(end, end + 1.75, across, across + 0.5);
      stripe(end + 1.75, end + 3.5, across, across + 0.5);
    }
  }
}

}  // namespace sweepcast::lab
