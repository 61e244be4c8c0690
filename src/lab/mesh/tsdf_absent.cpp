// Stands in for tsdf.cpp where the build found no OpenVDB.
#include "lab/mesh/tsdf.hpp"

namespace sweepcast::lab {

struct TsdfVolume::Field {};

TsdfVolume::TsdfVolume(std::unique_ptr<Field> field) : field_(std::move(field)) {}
TsdfVolume::~TsdfVolume() = default;
TsdfVolume::TsdfVolume(TsdfVolume&& other) noexcept = default;
TsdfVolume& TsdfVolume::operator=(TsdfVolume&& other) noexcept = default;

Result<TsdfVolume> TsdfVolume::create(const TsdfOptions& /*options*/) {
  return fail(ErrorCode::unsupported,
              "mesh: this build has no OpenVDB to fuse sweeps with; install libopenvdb-dev and "
              "libboost-dev, then configure and build again");
}

void TsdfVolume::add(std::span<const Ray> /*rays*/) {}

TriangleMesh TsdfVolume::surface(int /*min_weight*/) const {
  return {};
}

std::size_t TsdfVolume::memory_bytes() const {
  return 0;
}

}  // namespace sweepcast::lab
