#include "sweepcast/decoder.hpp"

#include <algorithm>

#include "codec/beam/codec.hpp"
#include "codec/rcpcc/codec.hpp"

namespace sweepcast {

struct Decoder::State {
  explicit State(const DecoderOptions& decoder_options)
      : options(decoder_options), beam(options.stages), rcpcc(options.stages) {}

  DecoderOptions options;
  FrameHeader header;
  beam::Decoder beam;
  rcpcc::Decoder rcpcc;

  Status decode(std::span<const std::byte> frame, PointCloud& cloud) {
    if (Status status = parse_frame_header(frame, header); !status) return status;
    const SweepCounts& counts = header.counts;
    const bool keeps_slots = header.codec == CodecId::beam &&
                             has_part(header, static_cast<std::uint8_t>(beam::Part::order));
    const std::size_t most = keeps_slots ? counts.points_in : counts.points_coded;
    if (most > options.max_points) {
      return fail(ErrorCode::limit, "the frame holds more points than the decoder may give");
    }
    if (header.codec == CodecId::beam) {
      return beam.decode(frame, header, options.max_layers, options.fill, cloud);
    }
    if (header.frame_size > frame.size()) {
      return fail(ErrorCode::truncated, "the frame is cut short");
    }
    if (header.codec != CodecId::rcpcc) {
      return fail(ErrorCode::unsupported, "the frame's codec is unknown; update this program");
    }
    return rcpcc.decode(frame, header, cloud);
  }
};

Decoder::Decoder(const DecoderOptions& options) : state_(std::make_unique<State>(options)) {}
Decoder::Decoder(Decoder&&) noexcept = default;
Decoder& Decoder::operator=(Decoder&&) noexcept = default;
Decoder::~Decoder() = default;

Status Decoder::decode(std::span<const std::byte> frame, PointCloud& cloud) {
  Status status = state_->decode(frame, cloud);
  if (!status) cloud.clear();
  return status;
}

const FrameHeader& Decoder::last_header() const noexcept {
  return state_->header;
}

}  // namespace sweepcast
