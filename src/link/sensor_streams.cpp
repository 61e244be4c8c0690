#include "link/sensor_streams.hpp"

#include <algorithm>

#include "codec/frame_edit.hpp"
#include "core/crc32.hpp"

namespace sweepcast::link {

Result<std::uint8_t> SensorStreams::number_of(std::string_view sensor) {
  const auto found = std::find_if(streams_.begin(), streams_.end(),
                                  [&](const Stream& stream) { return stream.sensor == sensor; });
  if (found != streams_.end()) return static_cast<std::uint8_t>(found - streams_.begin());
  if (streams_.size() == kMostStreams) {
    return fail(ErrorCode::limit, "a sender takes at most 16 sensors; start another one");
  }
  streams_.push_back({std::string(sensor), {}, 0, 0});
  return static_cast<std::uint8_t>(streams_.size() - 1);
}

Status SensorStreams::prepare_frame(std::uint8_t number, std::span<const std::byte>& frame,
                                    std::uint32_t& model) {
  Stream& stream = streams_[number];
  FrameHeader header;
  if (Status parsed = parse_frame_header(frame, header); !parsed) return parsed;
  const auto own = model_part(frame, header);
  if (!own) return tl::unexpected(own.error());
  if (!own->empty()) {
    stream.model.assign(own->begin(), own->end());
    stream.model_id = crc32(*own);
  }
  model = header.codec == CodecId::beam ? stream.model_id : 0;
  if (stream.model.empty()) return {};
  const bool receiver_has_it = stream.confirmed == stream.model_id;
  if (receiver_has_it == own->empty()) return {};
  const ModelPart what = receiver_has_it ? ModelPart::drop : ModelPart::put;
  if (Status done = rewrite_frame(frame, what, stream.model, rewritten_); !done) return done;
  frame = rewritten_;
  return {};
}

void SensorStreams::confirm(std::span<const StreamReport> reports) {
  for (const StreamReport& report : reports) {
    if (report.stream < streams_.size()) streams_[report.stream].confirmed = report.model;
  }
}

void SensorStreams::begin_connection() {
  for (Stream& stream : streams_) stream.confirmed = 0;
}

}  // namespace sweepcast::link
