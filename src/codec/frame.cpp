#include "sweepcast/frame.hpp"
namespace sweepcast {
std::string_view name(CodecId codec) noexcept {
  return codec == CodecId::rcpcc ? "rcpcc" : "unknown";
}
Status parse_frame_header(std::span<const std::byte>, FrameHeader&) {
  return fail(ErrorCode::unsupported, "not there yet");
}
std::string_view part_name(CodecId, std::uint8_t) noexcept {
  return "unknown";
}
}  // namespace sweepcast
