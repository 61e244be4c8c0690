// Triangles of the simulated world, and the few shapes that it is built of.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lab/simulate/geometry.hpp"

namespace sweepcast::lab {

/// How a surface answers a laser pulse; see sweep.cpp for the model.
enum class Material : std::uint8_t { matt, foliage, paint, glass, retroreflector };

/// What a triangle is made of, and whose it is.
struct Surface {
  Material material = Material::matt;
  std::uint8_t albedo = 30;  ///< per cent of the light sent back; of glass, of pulses returned
  std::uint16_t object = 0;  ///< number of a boxed object; 0 is none
};

/// Triangles; coordinates are float so that what Embree sees is what we compute with.
struct Mesh {
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Surface> surfaces;  ///< one a triangle

  [[nodiscard]] Vec3 vertex(std::uint32_t index) const {
    const auto& v = vertices[index];
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
  }
};

/// Adds shapes to a mesh, given in the coordinates of `frame` and made of `surface`.
struct MeshBuilder {
  Mesh& mesh;
  Pose frame{};
  Surface surface{};

  std::uint32_t vertex(Vec3 local);
  void face(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  void triangle(Vec3 a, Vec3 b, Vec3 c);
  /// A quadrilateral given in order around it.
  void quad(Vec3 a, Vec3 b, Vec3 c, Vec3 d);
  /// A box without its bottom.
  void box(Vec3 low, Vec3 high);
  /// An upright truncated cone, open below, flat above.
  void cone(Vec3 base, double radius, double top_radius, double height, int sides);
  /// The surface between two outlines of equally many points, closed.
  void band(const std::vector<Vec3>& lower, const std::vector<Vec3>& upper);
};

}  // namespace sweepcast::lab
