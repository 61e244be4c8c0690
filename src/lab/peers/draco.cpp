#include "lab/peers/draco.hpp"

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/point_cloud/point_cloud.h>

#include <array>
#include <cmath>
#include <cstdint>

namespace sweepcast::lab {
namespace {

constexpr auto kPosition = draco::GeometryAttribute::POSITION;

using Points = std::vector<std::array<float, 3>>;

Points finite_points(const PointCloud& cloud) {
  Points points;
  points.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::array<float, 3> point{cloud.x[i], cloud.y[i], cloud.z[i]};
    if (std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2])) {
      points.push_back(point);
    }
  }
  return points;
}

/// At least one point, as Draco wants them.
std::unique_ptr<draco::PointCloud> to_draco(const Points& points) {
  auto attribute = std::make_unique<draco::PointAttribute>();
  attribute->Init(kPosition, 3, draco::DT_FLOAT32, false, points.size());
  attribute->buffer()->Write(0, points.data(), points.size() * sizeof(points[0]));
  auto result = std::make_unique<draco::PointCloud>();
  result->set_num_points(static_cast<std::uint32_t>(points.size()));
  result->AddAttribute(std::move(attribute));
  return result;
}

Status from_draco(const draco::PointCloud& decoded, PointCloud& cloud) {
  const draco::PointAttribute* position = decoded.GetNamedAttribute(kPosition);
  if (position == nullptr) return fail(ErrorCode::corrupt, "draco: the result has no positions");
  cloud.clear();
  cloud.resize_xyz(decoded.num_points());
  for (std::uint32_t i = 0; i < decoded.num_points(); ++i) {
    std::array<float, 3> point{};
    position->GetMappedValue(draco::PointIndex(i), point.data());
    cloud.x[i] = point[0];
    cloud.y[i] = point[1];
    cloud.z[i] = point[2];
  }
  return {};
}

Status failed(const draco::Status& status) {
  return fail(ErrorCode::corrupt, "draco: " + status.error_msg_string());
}

class DracoPeer : public Peer {
 public:
  explicit DracoPeer(const DracoOptions& options)
      : Peer("draco-kd", "qp" + std::to_string(options.quantisation_bits) + " cl" +
                             std::to_string(options.compression_level)) {
    const int speed = 10 - options.compression_level;
    encoder_.SetSpeedOptions(speed, speed);
    encoder_.SetAttributeQuantization(kPosition, options.quantisation_bits);
    encoder_.SetEncodingMethod(draco::POINT_CLOUD_KD_TREE_ENCODING);
  }

  Result<std::span<const std::byte>> encode(const PointCloud& cloud) override {
    const Points points = finite_points(cloud);
    if (points.empty()) return std::span<const std::byte>{};  // Draco refuses these
    buffer_.Clear();
    const draco::Status status = encoder_.EncodePointCloudToBuffer(*to_draco(points), &buffer_);
    if (!status.ok()) return tl::unexpected(failed(status).error());
    return std::as_bytes(std::span(buffer_.data(), buffer_.size()));
  }

  Status decode(std::span<const std::byte> bytes, PointCloud& cloud) override {
    cloud.clear();
    if (bytes.empty()) return {};
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    auto decoded = draco::Decoder().DecodePointCloudFromBuffer(&buffer);
    if (!decoded.ok()) return failed(decoded.status());
    return from_draco(*decoded.value(), cloud);
  }

 private:
  draco::Encoder encoder_;
  draco::EncoderBuffer buffer_;
};

}  // namespace

Result<std::unique_ptr<Peer>> make_draco_peer(const DracoOptions& options) {
  if (options.quantisation_bits < 1 || options.quantisation_bits > 30) {
    return fail(ErrorCode::invalid_argument, "draco: quantisation bits must be from 1 to 30");
  }
  if (options.compression_level < 0 || options.compression_level > 10) {
    return fail(ErrorCode::invalid_argument, "draco: compression level must be from 0 to 10");
  }
  return std::make_unique<DracoPeer>(options);
}

}  // namespace sweepcast::lab
