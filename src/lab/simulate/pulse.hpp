// One laser pulse: what it meets, at what range, and what comes back.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "lab/random.hpp"
#include "lab/simulate/mesh.hpp"
#include "lab/simulate/ray_scene.hpp"
#include "lab/simulate/sensors.hpp"

namespace sweepcast::lab {

/// Triangles and the scene to find them with; moving ones have a second set of vertices.
struct Solid {
  Mesh mesh;
  std::vector<std::array<float, 3>> end;  ///< the vertices at time 1; empty where all is at rest
  std::optional<RayScene> scene;          ///< none where there is no triangle

  /// Prepares the scene. Errors: Embree's.
  [[nodiscard]] Status commit();
};

/// Where a ray meets a surface.
struct Impact {
  double range = 0.0;   ///< from the ray's origin, exact to double's rounding
  double cosine = 0.0;  ///< of the angle between ray and surface normal, in [0, 1]
  Surface surface;
};

/// The first surface on the ray of unit `direction` from `origin` (world frame) at `time` in
/// [0, 1] of the sweep; none within `max_range`, or one met at under half a degree.
[[nodiscard]] std::optional<Impact> meet(const Solid& solid, Vec3 origin, Vec3 direction,
                                         double max_range, double time);

/// What a pulse brings back.
struct Echo {
  double range = 0.0;
  double intensity = 0.0;  ///< in the sensor's unit
};

/// The sensor's answer to an impact: none where too little light comes back, by the material, the
/// incidence and the range. `gain` is the beam's, on intensity. `random` belongs to this pulse
/// alone.
[[nodiscard]] std::optional<Echo> echo(const Sensor& sensor, double gain, const Impact& impact,
                                       double noise, bool dropouts, Random random);

/// Whether a beam ends on the roof of the sensor's own car. Sensor frame.
[[nodiscard]] bool meets_own_roof(Vec3 origin, Vec3 direction);

}  // namespace sweepcast::lab
