#include "sweepcast/decoder.hpp"
namespace sweepcast {
struct Decoder::State {
  FrameHeader header;
};
Decoder::Decoder(const DecoderOptions&) : state_(std::make_unique<State>()) {}
Decoder::Decoder(Decoder&&) noexcept = default;
Decoder& Decoder::operator=(Decoder&&) noexcept = default;
Decoder::~Decoder() = default;
Status Decoder::decode(std::span<const std::byte>, PointCloud& cloud) {
  cloud.clear();
  return fail(ErrorCode::unsupported, "not there yet");
}
const FrameHeader& Decoder::last_header() const noexcept {
  return state_->header;
}
}  // namespace sweepcast
