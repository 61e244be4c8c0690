#include "sweepcast/encoder.hpp"

#include "codec/beam/codec.hpp"
#include "codec/frame_layout.hpp"
#include "codec/rcpcc/codec.hpp"
#include "core/stage_lap.hpp"

namespace sweepcast {
namespace {

constexpr std::size_t kMostPoints = std::size_t{1} << 24;
constexpr std::size_t kLongestName = 255;

// Boxes and ranges without NaN, their ends in order.
Status check(const Crop& crop) {
  const auto in_order = [](const std::optional<Box>& box) {
    return !box ||
           (box->min_x <= box->max_x && box->min_y <= box->max_y && box->min_z <= box->max_z);
  };
  const bool ranges_ok =
      crop.min_range >= 0.0F && (crop.max_range == 0.0F || crop.max_range >= crop.min_range);
  if (ranges_ok && in_order(crop.keep) && in_order(crop.robot)) return {};
  return fail(ErrorCode::invalid_argument,
              "the crop is out of order: minima must be numbers and not exceed the maxima");
}

Status check(const CloudView& cloud, const SweepInfo& info) {
  if (cloud.size > 0 && !(cloud.x.present() && cloud.y.present() && cloud.z.present())) {
    return fail(ErrorCode::invalid_argument, "the cloud lacks x, y or z");
  }
  if (cloud.size > kMostPoints) {
    return fail(ErrorCode::limit, "the cloud has more than 2^24 points; split it into sweeps");
  }
  if (info.sensor.size() > kLongestName) {
    return fail(ErrorCode::invalid_argument, "the sensor's name has more than 255 bytes");
  }
  return {};
}

}  // namespace

struct Encoder::State {
  explicit State(const EncoderOptions& options)
      : codec(options.codec),
        beam(options.beam, options.crop, options.stages),
        rcpcc(options.rcpcc, options.crop, options.stages),
        stages(options.stages) {}

  CodecId codec;
  beam::Encoder beam;
  rcpcc::Encoder rcpcc;
  StageClock* stages;
  PartList parts;
  SweepCounts counts;
  std::vector<std::byte> frame;
};

Encoder::Encoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
Encoder::Encoder(Encoder&&) noexcept = default;
Encoder& Encoder::operator=(Encoder&&) noexcept = default;
Encoder::~Encoder() = default;

Result<Encoder> Encoder::create(const EncoderOptions& options) {
  if (options.codec != CodecId::rcpcc && options.codec != CodecId::beam) {
    return fail(ErrorCode::unsupported, "there is no encoder for this codec");
  }
  for (const Status& status :
       {check(options.crop), rcpcc::check(options.rcpcc), beam::check(options.beam)}) {
    if (!status) return tl::unexpected(status.error());
  }
  return Encoder(std::make_unique<State>(options));
}

Result<std::span<const std::byte>> Encoder::encode(const CloudView& cloud, const SweepInfo& info) {
  if (const Status status = check(cloud, info); !status) return tl::unexpected(status.error());
  State& s = *state_;
  const Status status = s.codec == CodecId::beam ? s.beam.encode(cloud, info, s.parts, s.counts)
                                                 : s.rcpcc.encode(cloud, s.parts, s.counts);
  if (!status) return tl::unexpected(status.error());
  StageLap lap(s.stages);
  write_frame(s.codec, info, s.counts, s.parts, s.frame);
  lap.end("frame");
  return s.frame;
}

Status Encoder::set_target_bytes(std::size_t bytes) {
  if (state_->codec == CodecId::beam) return state_->beam.set_target_bytes(bytes);
  return fail(ErrorCode::invalid_argument, "only codec beam can be given a number of bytes");
}

const SweepCounts& Encoder::last_counts() const noexcept {
  return state_->counts;
}

}  // namespace sweepcast
