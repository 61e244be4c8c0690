// A surface of triangles, and its files.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "sweepcast/status.hpp"

namespace sweepcast::lab {

struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;  ///< metres
  std::vector<std::array<std::uint32_t, 3>>
      triangles;  ///< vertices, counter-clockwise from outside

  /// A corner of a triangle, 0 to 2.
  [[nodiscard]] Eigen::Vector3d corner(std::size_t triangle, std::size_t which) const {
    return vertices[triangles[triangle][which]].cast<double>();
  }
};

/// Reads a PLY of triangles, ascii or binary: element `vertex` with x y z before element `face`
/// with a list `vertex_indices` (or `vertex_index`); faces of more corners are cut into triangles.
/// Errors: not_found, io, unsupported (no such elements), corrupt (a number; a vertex that is not
/// there or not finite), truncated, limit (over 2^27 vertices or faces, or 8 GiB).
[[nodiscard]] Result<TriangleMesh> read_mesh(const std::filesystem::path& file);

/// Writes a binary little-endian PLY, which is there whole or not at all. Errors: io.
[[nodiscard]] Status write_mesh(const std::filesystem::path& file, const TriangleMesh& mesh);

}  // namespace sweepcast::lab
