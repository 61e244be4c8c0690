#include "cloud_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return sweepcast::fuzz::check_cloud(data, size, sweepcast::parse_pcd, sweepcast::serialize_pcd);
}
