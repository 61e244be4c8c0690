#include "cloud_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto parse = [](std::span<const std::byte> bytes, sweepcast::PointCloud& cloud) {
    return sweepcast::parse_ply(bytes, cloud);
  };
  return sweepcast::fuzz::check_cloud(data, size, parse, sweepcast::serialize_ply);
}
