#include "lab/simulate/ray_scene.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <string>
#include <utility>

#if defined(__SSE2__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

namespace sweepcast::lab {
namespace {

/// Started once, with the first scene; scenes keep it alive through Embree's own reference count.
RTCDevice device() {
  static const RTCDevice shared = rtcNewDevice("isa=sse2,threads=1,set_affinity=0");
  return shared;
}

bool set_vertices(RTCGeometry geometry, unsigned slot,
                  const std::vector<std::array<float, 3>>& vertices) {
  void* buffer = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, slot, RTC_FORMAT_FLOAT3,
                                         3 * sizeof(float), vertices.size());
  if (buffer == nullptr) return false;
  std::copy(vertices.begin(), vertices.end(), static_cast<std::array<float, 3>*>(buffer));
  return true;
}

bool set_triangles(RTCGeometry geometry, const Mesh& mesh) {
  void* buffer = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                         3 * sizeof(std::uint32_t), mesh.triangles.size());
  if (buffer == nullptr) return false;
  std::copy(mesh.triangles.begin(), mesh.triangles.end(),
            static_cast<std::array<std::uint32_t, 3>*>(buffer));
  return true;
}

}  // namespace

struct RayScene::Handles {
  RTCScene scene = nullptr;

  Handles() = default;
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;
  ~Handles() {
    if (scene != nullptr) rtcReleaseScene(scene);
  }
};

Result<RayScene> RayScene::create(const Mesh& mesh, const std::vector<std::array<float, 3>>& end) {
  if (device() == nullptr) {
    return fail(ErrorCode::unsupported, "Embree: cannot start (code " +
                                            std::to_string(rtcGetDeviceError(nullptr)) +
                                            "); check that libembree3-3 fits this processor");
  }
  auto handles = std::make_shared<Handles>();
  handles->scene = rtcNewScene(device());
  rtcSetSceneFlags(handles->scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryTimeStepCount(geometry, end.empty() ? 1 : 2);
  const bool stored = set_vertices(geometry, 0, mesh.vertices) &&
                      (end.empty() || set_vertices(geometry, 1, end)) &&
                      set_triangles(geometry, mesh);
  if (stored) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(handles->scene, geometry);
    rtcCommitScene(handles->scene);
  }
  rtcReleaseGeometry(geometry);
  if (!stored || rtcGetDeviceError(device()) != RTC_ERROR_NONE) {
    return fail(ErrorCode::limit, "Embree: no memory for " + std::to_string(mesh.triangles.size()) +
                                      " triangles; free some and try again");
  }
  return RayScene(std::move(handles));
}

std::optional<std::uint32_t> RayScene::first_hit(Vec3 origin, Vec3 direction, double range,
                                                 double time) const {
  RTCRayHit query{};
  query.ray.org_x = static_cast<float>(origin.x);
  query.ray.org_y = static_cast<float>(origin.y);
  query.ray.org_z = static_cast<float>(origin.z);
  query.ray.dir_x = static_cast<float>(direction.x);
  query.ray.dir_y = static_cast<float>(direction.y);
  query.ray.dir_z = static_cast<float>(direction.z);
  query.ray.tfar = static_cast<float>(range);
  query.ray.time = static_cast<float>(time);
  query.ray.mask = ~0U;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(handles_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return query.hit.primID;
}

#if defined(__SSE2__)
FlushDenormals::FlushDenormals() : saved_(_mm_getcsr()) {
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
}
FlushDenormals::~FlushDenormals() {
  _mm_setcsr(saved_);
}
#else
FlushDenormals::FlushDenormals() = default;
FlushDenormals::~FlushDenormals() = default;
#endif

}  // namespace sweepcast::lab
