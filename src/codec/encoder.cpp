#include "sweepcast/encoder.hpp"
namespace sweepcast {
struct Encoder::State {
  SweepCounts counts;
};
Encoder::Encoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
Encoder::Encoder(Encoder&&) noexcept = default;
Encoder& Encoder::operator=(Encoder&&) noexcept = default;
Encoder::~Encoder() = default;
Result<Encoder> Encoder::create(const EncoderOptions&) {
  return Encoder(std::make_unique<State>());
}
Result<std::span<const std::byte>> Encoder::encode(const CloudView&, const SweepInfo&) {
  return fail(ErrorCode::unsupported, "not there yet");
}
const SweepCounts& Encoder::last_counts() const noexcept {
  return state_->counts;
}
}  // namespace sweepcast
