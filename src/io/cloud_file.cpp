#include "sweepcast/cloud_file.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "io/file.hpp"
#include "io/formats.hpp"
#include "io/record_table.hpp"

namespace sweepcast {
namespace {

/// A file is read as a whole; this is its largest size.
constexpr std::size_t kMaxFileSize = std::size_t{1} << 30;

Status parse(std::span<const std::byte> bytes, CloudFormat format, PointCloud& cloud,
             std::vector<std::string>* skipped) {
  switch (format) {
    case CloudFormat::bin:
      return parse_bin(bytes, cloud);
    case CloudFormat::pcd:
      return parse_pcd(bytes, cloud, skipped);
    case CloudFormat::ply:
      return parse_ply(bytes, cloud, skipped);
  }
  return fail(ErrorCode::invalid_argument, "no such cloud format");
}

void serialize(const PointCloud& cloud, CloudFormat format, CloudEncoding encoding,
               std::vector<std::byte>& out) {
  switch (format) {
    case CloudFormat::bin:
      return serialize_bin(cloud, out);
    case CloudFormat::pcd:
      return serialize_pcd(cloud, encoding, out);
    case CloudFormat::ply:
      return serialize_ply(cloud, encoding, out);
  }
}

bool columns_fit(const PointCloud& cloud) {
  const auto fits = [&](std::size_t size) { return size == 0 || size == cloud.size(); };
  return cloud.y.size() == cloud.size() && cloud.z.size() == cloud.size() &&
         fits(cloud.intensity.size()) && fits(cloud.ring.size()) && fits(cloud.time_ns.size());
}

bool encoding_fits(CloudFormat format, CloudEncoding encoding) {
  return encoding == CloudEncoding::binary || format == CloudFormat::pcd ||
         (format == CloudFormat::ply && encoding == CloudEncoding::ascii);
}

}  // namespace

std::string_view name(CloudFormat format) noexcept {
  switch (format) {
    case CloudFormat::bin:
      return "bin";
    case CloudFormat::pcd:
      return "pcd";
    case CloudFormat::ply:
      return "ply";
  }
  return "unknown";
}

std::optional<CloudFormat> cloud_format_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  for (const CloudFormat format : {CloudFormat::bin, CloudFormat::pcd, CloudFormat::ply}) {
    if (extension.size() == 4 && extension.substr(1) == name(format)) return format;
  }
  return std::nullopt;
}

Status read_cloud(const std::filesystem::path& path, PointCloud& cloud,
                  std::vector<std::string>* skipped_fields) {
  cloud.clear();
  if (skipped_fields != nullptr) skipped_fields->clear();
  const auto format = cloud_format_of(path);
  if (!format) {
    return fail(ErrorCode::unsupported,
                path.string() + ": is not named as a cloud; clouds end in .bin, .pcd or .ply");
  }
  std::vector<std::byte> bytes;
  if (Status status = read_file(path, kMaxFileSize, bytes); !status) return status;
  Status status = parse(bytes, *format, cloud, skipped_fields);
  if (status) return status;
  cloud.clear();
  return fail(status.error().code, path.string() + ": " + status.error().message);
}

Status write_cloud(const std::filesystem::path& path, const PointCloud& cloud, CloudFormat format,
                   CloudEncoding encoding) {
  if (!encoding_fits(format, encoding)) {
    return fail(ErrorCode::invalid_argument,
                path.string() + ": a ." + std::string(name(format)) +
                    " cannot be written in this encoding; choose binary");
  }
  if (!columns_fit(cloud) || cloud.size() > kMaxPoints) {
    return fail(ErrorCode::invalid_argument,
                path.string() +
                    ": the cloud's columns differ in length or exceed 2^24 points; "
                    "give each as many entries as x, or none");
  }
  std::vector<std::byte> bytes;
  serialize(cloud, format, encoding, bytes);
  return write_file(path, bytes);
}

}  // namespace sweepcast
