// Stands in for ray_scene.cpp where the build found no Embree.
#include "lab/simulate/ray_scene.hpp"

namespace sweepcast::lab {

struct RayScene::Handles {};

Result<RayScene> RayScene::create(const Mesh& /*mesh*/,
                                  const std::vector<std::array<float, 3>>& /*end*/) {
  return fail(ErrorCode::unsupported,
              "simulate: this build has no Embree to cast rays with; install libembree-dev, then "
              "configure and build again");
}

std::optional<std::uint32_t> RayScene::first_hit(Vec3 /*origin*/, Vec3 /*direction*/,
                                                 double /*range*/, double /*time*/) const {
  return std::nullopt;
}

FlushDenormals::FlushDenormals() = default;
FlushDenormals::~FlushDenormals() {}  // as declared for the file that has Embree

}  // namespace sweepcast::lab
