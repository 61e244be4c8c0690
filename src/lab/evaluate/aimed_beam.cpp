#include "lab/evaluate/aimed_beam.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "codec/frame_edit.hpp"
#include "sweepcast/decoder.hpp"
#include "sweepcast/encoder.hpp"

namespace sweepcast::lab {
namespace {

constexpr double kMostChange = 0.1;  ///< of a frame's budget, to make up for what came before

EncoderOptions options_of(std::size_t target_bytes) {
  EncoderOptions options;
  options.codec = CodecId::beam;
  options.beam.fields = Fields::xyz;
  options.beam.target_bytes = target_bytes;
  return options;
}

Result<std::size_t> model_bytes(std::span<const std::byte> frame) {
  FrameHeader header;
  if (const Status parsed = parse_frame_header(frame, header); !parsed) {
    return tl::unexpected(parsed.error());
  }
  const auto model = model_part(frame, header);
  if (!model) return tl::unexpected(model.error());
  return model->size();
}

class AimedBeam : public Peer {
 public:
  AimedBeam(double ratio, double model_share, std::size_t models, Encoder encoder, bool fill)
      : Peer(fill ? "beam-fill" : "beam", fmt::format("ratio {}", ratio)),
        ratio_(ratio),
        model_share_(model_share),
        models_due_(models),
        encoder_(std::move(encoder)),
        decoder_(DecoderOptions{.fill = fill}) {}

  Result<std::span<const std::byte>> encode(const PointCloud& cloud) override {
    const double nominal =
        std::max(1.0, static_cast<double>(kBytesAPoint * cloud.size()) / ratio_ - model_share_);
    left_ += nominal;
    const double budget =
        std::clamp(left_, (1.0 - kMostChange) * nominal, (1.0 + kMostChange) * nominal);
    const Status set = encoder_.set_target_bytes(std::max<std::size_t>(1, std::size_t(budget)));
    if (!set) return tl::unexpected(set.error());
    auto frame = encoder_.encode(cloud, SweepInfo{});
    if (!frame) return frame;
    const auto model = model_bytes(*frame);
    if (!model) return tl::unexpected(model.error());
    left_ -= static_cast<double>(frame->size() - *model);
    if (*model > 0 && models_due_-- == 0) {  // one more, since the sensor seems to have changed
      models_due_ = 0;
      left_ -= static_cast<double>(*model);
    }
    return frame;
  }

  Status decode(std::span<const std::byte> bytes, PointCloud& cloud) override {
    return decoder_.decode(bytes, cloud);
  }

 private:
  double ratio_;
  double model_share_;      ///< of the models' bytes, that of each frame
  std::size_t models_due_;  ///< that the share allows for
  double left_ = 0.0;       ///< bytes that the frames so far might have had and did not use
  Encoder encoder_;
  Decoder decoder_;
};

}  // namespace

Result<std::unique_ptr<Peer>> make_aimed_beam(double ratio, const PointCloud& first,
                                              std::size_t sweeps, bool fill) {
  if (!(ratio >= 1.0) || sweeps == 0) {
    return fail(ErrorCode::invalid_argument,
                fmt::format("beam: ratio {} over {} sweeps; give 1 or more", ratio, sweeps));
  }
  const EncoderOptions probe_options = options_of(0);
  auto probe = Encoder::create(probe_options);
  if (!probe) return tl::unexpected(probe.error());
  const auto frame = probe->encode(first, SweepInfo{});
  if (!frame) return tl::unexpected(frame.error());
  const auto model = model_bytes(*frame);
  if (!model) return tl::unexpected(model.error());
  const auto interval = static_cast<std::size_t>(probe_options.beam.model_interval);
  const std::size_t models = (sweeps + interval - 1) / interval;
  const double share = static_cast<double>(*model * models) / static_cast<double>(sweeps);
  const double budget = static_cast<double>(kBytesAPoint * first.size()) / ratio - share;
  if (budget < 1.0) {
    return fail(ErrorCode::invalid_argument,
                fmt::format("beam: ratio {} leaves no byte beside the sensor's model; give more "
                            "sweeps, or a smaller ratio",
                            ratio));
  }
  auto encoder = Encoder::create(options_of(static_cast<std::size_t>(budget)));
  if (!encoder) return tl::unexpected(encoder.error());
  return std::make_unique<AimedBeam>(ratio, share, models, std::move(*encoder), fill);
}

}  // namespace sweepcast::lab
