#include "cloud_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto serialize = [](const sweepcast::PointCloud& cloud, sweepcast::CloudEncoding,
                            std::vector<std::byte>& out) { sweepcast::serialize_bin(cloud, out); };
  return sweepcast::fuzz::check_cloud(data, size, sweepcast::parse_bin, serialize);
}
