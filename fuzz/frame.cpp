// Decodes the input as a frame, its checksums made right.
#include <algorithm>
#include <cstdlib>

#include "repair_frame.hpp"
#include "sweepcast/decoder.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sweepcast;
  const auto input = std::as_bytes(std::span(data, size));
  std::vector<std::byte> frame(input.begin(), input.end());
  fuzz::repair_checksums(frame);
  static Decoder decoder;  // as a receiver keeps it
  PointCloud cloud;
  const Status status = decoder.decode(frame, cloud);
  // Codec beam gives fewer points where the frame is cut between layers.
  const std::size_t most = status ? decoder.last_header().counts.points_coded : 0;
  const bool may_be_fewer = decoder.last_header().codec == CodecId::beam;
  const std::size_t points = may_be_fewer ? std::min(most, cloud.x.size()) : most;
  if (cloud.x.size() != points || cloud.y.size() != points || cloud.z.size() != points) {
    std::abort();
  }
  return 0;
}
