// Meshing as a task: how far the surface of decoded sweeps is from that of the uncoded ones.
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lab/evaluate/tasks.hpp"
#include "lab/mesh/mesh_error.hpp"
#include "lab/mesh/seen_space.hpp"
#include "lab/mesh/sweep_rays.hpp"
#include "lab/mesh/triangle_mesh.hpp"
#include "lab/mesh/tsdf.hpp"
#include "lab/odometry/sweep_clock.hpp"
#include "sweepcast/cloud_file.hpp"

namespace sweepcast::lab {
namespace {

/// What all settings share.
struct MeshSetup {
  std::vector<std::filesystem::path> sweeps;
  std::vector<RigidTransform> poses;
  std::optional<std::filesystem::path> truth;
};

const TsdfOptions kVolume{};
const RangeLimits kLimits{};
const MeshErrorOptions kError{.thresholds_m = {0.1}};

/// The surfaces to compare with, and what the uncoded sweeps saw.
struct MeshReference {
  TriangleMesh mesh;
  SeenSpace seen;
  std::optional<TriangleMesh> truth;
};

/// Adds a sweep's rays to a volume; leaves them in `rays`.
void fuse(const MeshSetup& setup, std::size_t index, const PointCloud& cloud,
          std::span<const float> when, TsdfVolume& volume, std::vector<Ray>& rays) {
  rays_of(cloud, when, setup.poses[index], motion_during(setup.poses, index), kLimits, rays);
  volume.add(rays);
}

Result<MeshReference> make_reference(const MeshSetup& setup) {
  MeshReference reference;
  auto volume = TsdfVolume::create(kVolume);
  if (!volume) return tl::unexpected(volume.error());
  PointCloud cloud;
  std::vector<float> when;
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < setup.sweeps.size(); ++i) {
    if (Status read = read_cloud(setup.sweeps[i], cloud); !read) {
      return tl::unexpected(read.error());
    }
    when.clear();
    if (const auto clock = SweepClock::learn(cloud)) clock->tell(cloud, when);
    fuse(setup, i, cloud, when, *volume, rays);
    reference.seen.add(rays);
  }
  reference.mesh = volume->surface();
  if (setup.truth) {
    auto truth = read_mesh(*setup.truth);
    if (!truth) return tl::unexpected(truth.error());
    reference.truth = std::move(*truth);
  }
  return reference;
}

/// Made by the first that needs it; the others wait.
class SharedReference {
 public:
  explicit SharedReference(MeshSetup setup) : setup_(std::move(setup)) {}

  [[nodiscard]] const MeshSetup& setup() const { return setup_; }
  [[nodiscard]] const Result<MeshReference>& get() {
    std::call_once(made_, [this] { reference_ = make_reference(setup_); });
    return *reference_;
  }

 private:
  MeshSetup setup_;
  std::once_flag made_;
  std::optional<Result<MeshReference>> reference_;
};

class MeshRun : public TaskRun {
 public:
  MeshRun(SharedReference& shared, TsdfVolume volume)
      : shared_(shared), volume_(std::move(volume)) {}

  Status add(const SweepPair& sweep) override {
    fuse(shared_.setup(), sweep.index, sweep.decoded, sweep.when, volume_, rays_);
    return {};
  }

  Result<Figures> finish() override {
    const Result<MeshReference>& reference = shared_.get();
    if (!reference) return tl::unexpected(reference.error());
    const TriangleMesh mesh = volume_.surface();
    Figures figures{{"mesh_f10", 0.0}, {"mesh_f10_truth", kNone}};
    if (mesh.triangles.empty()) {
      if (reference->truth) figures[1].value = 0.0;
      return figures;
    }
    const auto error = mesh_error(mesh, reference->mesh, kError);
    if (!error) return tl::unexpected(error.error());
    figures[0].value = error->scores.front().f_score;
    if (!reference->truth) return figures;
    const auto is_seen = [&](const Eigen::Vector3d& place) {
      return reference->seen.is_seen(place);
    };
    const auto truth = mesh_error(mesh, *reference->truth, kError, is_seen);
    if (!truth) return tl::unexpected(truth.error());
    figures[1].value = truth->scores.front().f_score;
    return figures;
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  SharedReference& shared_;
  TsdfVolume volume_;
  std::vector<Ray> rays_;
};

class MeshTask : public Task {
 public:
  MeshTask(std::string key, MeshSetup setup)
      : Task("mesh", std::move(key), 1),
        shared_(std::make_unique<SharedReference>(std::move(setup))) {}

  Result<std::unique_ptr<TaskRun>> begin() const override {
    auto volume = TsdfVolume::create(kVolume);
    if (!volume) return tl::unexpected(volume.error());
    return std::make_unique<MeshRun>(*shared_, std::move(*volume));
  }

 private:
  std::unique_ptr<SharedReference> shared_;
};

}  // namespace

Result<std::unique_ptr<const Task>> make_mesh_task(const DriveFiles& drive,
                                                   const TaskOptions& /*options*/) {
  if (drive.poses.empty()) {
    return fail(ErrorCode::not_found, drive.folder.string() +
                                          ": has no poses.txt to put the sweeps together by; put "
                                          "the true poses there, a KITTI line a sweep");
  }
  if (const auto volume = TsdfVolume::create(kVolume); !volume) {
    return tl::unexpected(volume.error());
  }
  std::string key = "poses " + drive.poses_hash;
  if (drive.mesh) {
    const auto hash = hash_file(*drive.mesh);
    if (!hash) return tl::unexpected(hash.error());
    key += ", mesh " + *hash;
  }
  return std::make_unique<MeshTask>(std::move(key),
                                    MeshSetup{drive.sweeps, drive.poses, drive.mesh});
}

}  // namespace sweepcast::lab
