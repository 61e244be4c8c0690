// The cloud formats, in memory. Messages lack the file's path: `read_cloud` puts it in front.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sweepcast/cloud.hpp"
#include "sweepcast/cloud_file.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast {

/// KITTI: float32 x, y, z, intensity, little-endian, no header. Any content is a cloud, so bytes
/// that begin as a file of another kind are refused.
/// Errors: truncated (empty, or not 16 bytes a point), unsupported (another kind), limit.
[[nodiscard]] Status parse_bin(std::span<const std::byte> bytes, PointCloud& cloud);

/// PCD 0.7: all encodings, field types and counts. The viewpoint is ignored, an organised cloud
/// becomes a list. What follows the points of a binary file is ignored.
/// Errors: corrupt, truncated, unsupported (not a PCD, no x y z), limit.
/// `skipped`: see `read_cloud`.
[[nodiscard]] Status parse_pcd(std::span<const std::byte> bytes, PointCloud& cloud,
                               std::vector<std::string>* skipped = nullptr);

/// PLY 1.0: all encodings; the element "vertex" wherever it stands, other elements and lists are
/// passed over. What follows the vertices is ignored.
/// Errors: corrupt, truncated, unsupported (not a PLY, no vertex, no x y z), limit.
/// `skipped`: see `read_cloud`.
[[nodiscard]] Status parse_ply(std::span<const std::byte> bytes, PointCloud& cloud,
                               std::vector<std::string>* skipped = nullptr);

/// Writers; `out` is cleared first. PCD and PLY have the fields that the cloud has. PLY's binary is
/// little-endian, and it has no compressed form.
void serialize_bin(const PointCloud& cloud, std::vector<std::byte>& out);
void serialize_pcd(const PointCloud& cloud, CloudEncoding encoding, std::vector<std::byte>& out);
void serialize_ply(const PointCloud& cloud, CloudEncoding encoding, std::vector<std::byte>& out);

}  // namespace sweepcast
