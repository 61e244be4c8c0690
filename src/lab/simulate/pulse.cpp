#include "lab/simulate/pulse.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sweepcast::lab {
namespace {

// The share of light that a surface sends back, relative to a white wall that faces the beam.
double brightness(const Impact& impact, Random& random) {
  const double albedo = impact.surface.albedo / 100.0;
  const double cosine = impact.cosine;
  switch (impact.surface.material) {
    case Material::foliage:  // a leaf fills a part of the beam
      return albedo * random.uniform(0.45, 1.0);
    case Material::paint:  // clear coat: a mirror that also scatters a little
      return albedo * (0.25 + 0.75 * cosine) + (cosine > 0.985 ? 0.4 : 0.0);
    case Material::glass:  // mostly a window on darkness; the albedo says how often it is not
      return random.chance(albedo) ? 0.12 + 0.2 * cosine * cosine : 0.0;
    case Material::retroreflector:
      return cosine > 0.25 ? 2.5 * albedo : 0.3 * albedo;
    case Material::matt:
      break;
  }
  return albedo * (0.55 + 0.45 * cosine);
}

double round_to(double value, double step) {
  return std::floor(value / step + 0.5) * step;
}

}  // namespace

Status Solid::commit() {
  if (mesh.triangles.empty()) return {};
  auto made = RayScene::create(mesh, end);
  if (!made) return tl::unexpected(std::move(made.error()));
  scene = std::move(*made);
  return {};
}

std::optional<Impact> meet(const Solid& solid, Vec3 origin, Vec3 direction, double max_range,
                           double time) {
  constexpr double kGrazing = 0.0087;
  if (!solid.scene) return std::nullopt;
  const auto hit = solid.scene->first_hit(origin, direction, max_range, time);
  if (!hit) return std::nullopt;
  const auto corner = [&](int i) {
    const std::uint32_t index = solid.mesh.triangles[*hit][static_cast<std::size_t>(i)];
    const Vec3 begin = solid.mesh.vertex(index);
    if (solid.end.empty()) return begin;
    const auto& v = solid.end[index];
    const Vec3 end{static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
    return begin + (end - begin) * time;
  };
  const Vec3 a = corner(0);
  const Vec3 normal = cross(corner(1) - a, corner(2) - a);
  const double approach = dot(normal, direction);
  const double size = length(normal);
  const double cosine = std::abs(approach) / size;
  if (!(cosine > kGrazing)) return std::nullopt;  // also a triangle without area
  const double range = dot(normal, a - origin) / approach;
  if (!(range > 0.0 && range <= max_range)) return std::nullopt;
  return Impact{range, std::min(cosine, 1.0), solid.mesh.surfaces[*hit]};
}

std::optional<Echo> echo(const Sensor& sensor, double gain, const Impact& impact, double noise,
                         bool dropouts, Random random) {
  constexpr double kStray = 0.003;     // pulses lost for no reason that we model
  constexpr double kReference = 0.25;  // the albedo that `reach_m` is stated for
  const double bright = brightness(impact, random);
  if (dropouts) {
    // A footprint on a slant is smeared along the beam, which lowers the pulse's peak.
    const double slant = std::sqrt(impact.cosine);
    const double far = impact.range / sensor.reach_m;
    const double signal = bright * slant / (kReference * far * far);
    const double power = signal * signal;
    if (!random.chance(power / (1.0 + power)) || random.chance(kStray)) return std::nullopt;
  }
  const double scatter = noise * sensor.range_sigma_m * random.normal();
  const double range = round_to(impact.range + scatter, sensor.range_step_m);
  if (range < sensor.min_range_m || range > sensor.max_range_m) return std::nullopt;
  const double speckle = 1.0 + 0.06 * random.normal();
  const double intensity =
      std::clamp(gain * sensor.intensity_scale * bright * speckle, 0.0, sensor.intensity_max);
  return Echo{range, round_to(intensity, sensor.intensity_step)};
}

bool meets_own_roof(Vec3 origin, Vec3 direction) {
  constexpr double kRoof = -0.42;
  constexpr double kFront = 1.2;
  constexpr double kRear = -2.3;
  constexpr double kHalfWidth = 0.7;
  if (direction.z >= 0.0) return false;
  const Vec3 p = origin + direction * ((kRoof - origin.z) / direction.z);
  return p.x > kRear && p.x < kFront && std::abs(p.y) < kHalfWidth;
}

}  // namespace sweepcast::lab
