// What Foxglove and Lichtblick understand: foxglove.PointCloud in Protocol Buffers, and the schema
// that describes it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "sweepcast/cloud.hpp"
#include "view/sweep.hpp"

namespace sweepcast::view {

inline constexpr std::string_view kPointCloudSchema = "foxglove.PointCloud";

/// A google.protobuf.FileDescriptorSet: foxglove.PointCloud and all that it refers to.
[[nodiscard]] Bytes point_cloud_descriptors();

/// RFC 4648, with padding.
[[nodiscard]] std::string base64(std::span<const std::byte> bytes);

/// A foxglove.PointCloud of the cloud's columns: float32 x, y, z, intensity, uint16 ring.
/// `stamp_ns`: since 1970. Points without coordinates are left out.
[[nodiscard]] Bytes point_cloud_message(const PointCloud& cloud, std::int64_t stamp_ns,
                                        std::string_view frame_id);

}  // namespace sweepcast::view
