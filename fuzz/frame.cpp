// Decodes the input as a frame, its checksums made right.
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
  const std::size_t points = status ? decoder.last_header().counts.points_coded : 0;
  if (cloud.x.size() != points || cloud.y.size() != points || cloud.z.size() != points) {
    std::abort();
  }
  return 0;
}
