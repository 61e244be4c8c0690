// Embree behind a small door: which triangle does a ray meet first?
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "lab/simulate/mesh.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// Triangles ready for ray casting; safe to use from many threads at once.
///
/// Embree's kernels differ in their last bits from one instruction set to the next, so it is held
/// to the one that every x86-64 machine has (SSE2), and it only names a triangle: whoever asks
/// computes the range from that triangle's plane. What may still differ on another processor
/// family is the choice at an edge that a ray hits to within float rounding.
class RayScene {
 public:
  /// Triangles of `mesh` at rest, or, where `end` has as many vertices, moving in a straight line
  /// from the mesh's vertices at time 0 to `end` at time 1.
  /// Errors: limit (Embree has no memory), unsupported (Embree cannot start).
  [[nodiscard]] static Result<RayScene> create(const Mesh& mesh,
                                               const std::vector<std::array<float, 3>>& end = {});

  /// The first triangle on the ray of unit `direction` from `origin`, no farther than `range`.
  [[nodiscard]] std::optional<std::uint32_t> first_hit(Vec3 origin, Vec3 direction, double range,
                                                       double time = 0.0) const;

 private:
  struct Handles;
  explicit RayScene(std::shared_ptr<const Handles> handles) : handles_(std::move(handles)) {}
  std::shared_ptr<const Handles> handles_;
};

/// Sets the floating-point mode that Embree asks for (denormals are zero) on this thread, and
/// restores the old one at the end.
class FlushDenormals {
 public:
  FlushDenormals();
  ~FlushDenormals();
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned saved_ = 0;
};

}  // namespace sweepcast::lab
