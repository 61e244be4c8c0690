#include "lab/simulate/mesh.hpp"

#include "core/trig.hpp"

namespace sweepcast::lab {

std::uint32_t MeshBuilder::vertex(Vec3 local) {
  const Vec3 p = frame.apply(local);
  mesh.vertices.push_back(
      {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

void MeshBuilder::face(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh.triangles.push_back({a, b, c});
  mesh.surfaces.push_back(surface);
}

void MeshBuilder::triangle(Vec3 a, Vec3 b, Vec3 c) {
  const std::uint32_t first = vertex(a);
  vertex(b);
  vertex(c);
  face(first, first + 1, first + 2);
}

void MeshBuilder::quad(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const std::uint32_t first = vertex(a);
  vertex(b);
  vertex(c);
  vertex(d);
  face(first, first + 1, first + 2);
  face(first, first + 2, first + 3);
}

void MeshBuilder::box(Vec3 low, Vec3 high) {
  const std::vector<Vec3> bottom{
      low, {high.x, low.y, low.z}, {high.x, high.y, low.z}, {low.x, high.y, low.z}};
  const std::vector<Vec3> top{
      {low.x, low.y, high.z}, {high.x, low.y, high.z}, high, {low.x, high.y, high.z}};
  band(bottom, top);
  quad(top[0], top[1], top[2], top[3]);
}

void MeshBuilder::cone(Vec3 base, double radius, double top_radius, double height, int sides) {
  std::vector<Vec3> lower;
  std::vector<Vec3> upper;
  for (int i = 0; i < sides; ++i) {
    const SinCos angle = sin_cos(2.0 * kPi * i / sides);
    lower.push_back(base + Vec3{radius * angle.cos, radius * angle.sin, 0.0});
    upper.push_back(base + Vec3{top_radius * angle.cos, top_radius * angle.sin, height});
  }
  band(lower, upper);
  const Vec3 top = base + Vec3{0.0, 0.0, height};
  for (std::size_t i = 0; i < upper.size(); ++i) {
    triangle(upper[i], upper[(i + 1) % upper.size()], top);
  }
}

void MeshBuilder::band(const std::vector<Vec3>& lower, const std::vector<Vec3>& upper) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto count = static_cast<std::uint32_t>(lower.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    vertex(lower[i]);
    vertex(upper[i]);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t here = first + 2 * i;
    const std::uint32_t next = first + 2 * ((i + 1) % count);
    face(here, next, next + 1);
    face(here, next + 1, here + 1);
  }
}

}  // namespace sweepcast::lab
