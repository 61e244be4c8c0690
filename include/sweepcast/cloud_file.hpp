// Clouds in files: KITTI .bin, PCD and PLY. Part of library sweepcast::io.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sweepcast/cloud.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast {

/// The formats of a single cloud.
enum class CloudFormat : std::uint8_t {
  bin,  ///< KITTI: float32 x, y, z, intensity; metres; no header
  pcd,  ///< Point Cloud Library 0.7
  ply,  ///< Stanford PLY 1.0
};

/// How numbers are written. KITTI .bin is always `binary`; `binary_compressed` is PCD's alone.
enum class CloudEncoding : std::uint8_t { ascii, binary, binary_compressed };

/// "bin", "pcd", "ply".
[[nodiscard]] std::string_view name(CloudFormat format) noexcept;

/// The format that a file's extension names, in any case; none for other extensions.
[[nodiscard]] std::optional<CloudFormat> cloud_format_of(const std::filesystem::path& path);

/// Reads one cloud; the extension decides the format. Reuses the memory of `cloud`.
///
/// Fields taken, by name (upper or lower case): x y z; intensity (also i, reflectivity,
/// scalar_Intensity); ring (also channel, laser_id); time (also t, timestamp, time_stamp,
/// time_offset): floating point counts as seconds, integers as nanoseconds. Times are made relative
/// to the smallest one, so that the first firing is 0. Other fields are skipped; where
/// `skipped_fields` is given, their names are put there, as the file has them, in its order
/// (padding, named "_", is none). In a .bin file the fourth column is intensity. Coordinates that
/// are NaN or infinite stay so. A PCD of more than one row (HEIGHT) is an organised cloud, and an
/// organised cloud is written as one to PCD.
///
/// Errors: not_found, io, corrupt (with the line or byte at fault), truncated, unsupported
/// (extension, content of another kind, as text or random bytes in a .bin, no x y z), limit (over
/// 2^24 points or 1 GiB). Messages start with the file's path; the cloud is then empty.
[[nodiscard]] Status read_cloud(const std::filesystem::path& path, PointCloud& cloud,
                                std::vector<std::string>* skipped_fields = nullptr);

/// Writes one cloud under a temporary name in the same folder and renames it, so that a file is
/// there whole or not at all; a device or pipe is written directly. A .bin has intensity 0 where
/// the cloud has none; PCD and PLY carry x y z and the columns that the cloud has, time as float64
/// seconds. Errors: io (unwritable folder, full disk), invalid_argument (encoding and format do not
/// fit, columns of different lengths, over 2^24 points).
[[nodiscard]] Status write_cloud(const std::filesystem::path& path, const PointCloud& cloud,
                                 CloudFormat format,
                                 CloudEncoding encoding = CloudEncoding::binary);

}  // namespace sweepcast
