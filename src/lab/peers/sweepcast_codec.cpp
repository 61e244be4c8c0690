#include "lab/peers/sweepcast_codec.hpp"

#include "sweepcast/decoder.hpp"

namespace sweepcast::lab {
namespace {

class SweepcastPeer : public Peer {
 public:
  SweepcastPeer(std::string codec, std::string setting, Encoder encoder,
                const DecoderOptions& decoder)
      : Peer(std::move(codec), std::move(setting)),
        encoder_(std::move(encoder)),
        decoder_(decoder) {}

  Result<std::span<const std::byte>> encode(const PointCloud& cloud) override {
    return encoder_.encode(cloud, SweepInfo{});
  }

  Status decode(std::span<const std::byte> bytes, PointCloud& cloud) override {
    return decoder_.decode(bytes, cloud);
  }

 private:
  Encoder encoder_;
  Decoder decoder_;
};

}  // namespace

Result<std::unique_ptr<Peer>> make_sweepcast_peer(const EncoderOptions& options,
                                                  std::string setting,
                                                  const DecoderOptions& decoder) {
  EncoderOptions geometry_only = options;
  geometry_only.beam.fields = Fields::xyz;
  geometry_only.beam.keep_order = false;
  geometry_only.beam.lossless = false;
  auto encoder = Encoder::create(geometry_only);
  if (!encoder) return tl::unexpected(std::move(encoder.error()));
  return std::make_unique<SweepcastPeer>(std::string(name(options.codec)), std::move(setting),
                                         std::move(*encoder), decoder);
}

}  // namespace sweepcast::lab
