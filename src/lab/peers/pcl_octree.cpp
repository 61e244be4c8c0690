#include "lab/peers/pcl_octree.hpp"

#include <fmt/core.h>
#include <pcl/compression/octree_pointcloud_compression.h>
// The codec's templates, made here: libpcl_io, which has them too, needs 60 libraries to start.
#include <pcl/point_types.h>
#include <pcl/io/impl/entropy_range_coder.hpp>
#include <pcl/io/impl/octree_pointcloud_compression.hpp>

#include <array>
#include <cmath>
#include <exception>
#include <sstream>
#include <string>
#include <utility>

#include "lab/peers/checked_frame.hpp"

namespace sweepcast::lab {
namespace {

using Codec = pcl::io::OctreePointCloudCompression<pcl::PointXYZ>;
using PclCloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr double kMaxSteps = 1 << 20;  // from the sensor: PCL's keys are finite

/// The points that are finite and near enough.
PclCloud::Ptr to_pcl(const PointCloud& cloud, double step_m) {
  PclCloud::Ptr result(new PclCloud);
  const double most = kMaxSteps * step_m;
  const auto is_near = [&](float v) { return std::abs(double{v}) < most; };
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (is_near(cloud.x[i]) && is_near(cloud.y[i]) && is_near(cloud.z[i])) {
      result->push_back({cloud.x[i], cloud.y[i], cloud.z[i]});
    }
  }
  return result;
}

void from_pcl(const PclCloud& decoded, PointCloud& cloud) {
  cloud.clear();
  for (const pcl::PointXYZ& point : decoded) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z)) continue;
    cloud.x.push_back(point.x);
    cloud.y.push_back(point.y);
    cloud.z.push_back(point.z);
  }
}

Status failed(const std::exception& error) {
  return fail(ErrorCode::corrupt, std::string("pcl: ") + error.what());
}

class PclOctreePeer : public Peer {
 public:
  explicit PclOctreePeer(const PclOctreeOptions& options)
      : Peer("pcl-octree", fmt::format("step {} m", options.step_m)), step_m_(options.step_m) {}

  Result<std::span<const std::byte>> encode(const PointCloud& cloud) override {
    const PclCloud::Ptr points = to_pcl(cloud, step_m_);
    if (points->empty()) return std::span<const std::byte>{};
    std::string coded;
    try {
      std::ostringstream stream;
      codec().encodePointCloud(points, stream);
      coded = stream.str();
    } catch (const std::exception& error) {
      return tl::unexpected(failed(error).error());
    }
    write_checked(std::as_bytes(std::span(coded.data(), coded.size())), frame_);
    return std::span<const std::byte>(frame_);
  }

  Status decode(std::span<const std::byte> bytes, PointCloud& cloud) override {
    cloud.clear();
    if (bytes.empty()) return {};
    const auto coded = read_checked(bytes);
    if (!coded) return fail(ErrorCode::corrupt, "pcl: the checksum does not match");
    try {
      std::istringstream stream(
          std::string(reinterpret_cast<const char*>(coded->data()), coded->size()));
      PclCloud::Ptr decoded(new PclCloud);
      codec().decodePointCloud(stream, decoded);
      from_pcl(*decoded, cloud);
    } catch (const std::exception& error) {
      return failed(error);
    }
    return {};
  }

 private:
  /// A new one for every sweep, so that none refers to the one before.
  [[nodiscard]] Codec codec() const {
    return Codec(pcl::io::MANUAL_CONFIGURATION, false, step_m_, step_m_, true, 1, false);
  }

  double step_m_;
  std::vector<std::byte> frame_;
};

}  // namespace

Result<std::unique_ptr<Peer>> make_pcl_octree_peer(const PclOctreeOptions& options) {
  if (!(options.step_m >= 0.001 && options.step_m <= 100.0)) {
    return fail(ErrorCode::invalid_argument,
                fmt::format("pcl: a step of {} m; give one from 0.001 to 100 m", options.step_m));
  }
  return std::make_unique<PclOctreePeer>(options);
}

Result<Peers> pcl_octree_ladder() {
  static constexpr std::array<double, 9> kSteps{0.01, 0.02, 0.03, 0.05, 0.08, 0.1, 0.15, 0.25, 0.4};
  return make_ladder(kSteps, [](double step) { return make_pcl_octree_peer({.step_m = step}); });
}

}  // namespace sweepcast::lab
