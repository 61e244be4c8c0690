#include "lab/peers/sweepcast_codec.hpp"

#include "sweepcast/decoder.hpp"

namespace sweepcast::lab {
namespace {

struct Clocks {
  StageClock encode, decode;
};

class SweepcastPeer : public Peer {
 public:
  /// The clocks are those that the encoder and the decoder were given.
  SweepcastPeer(std::string codec, std::string setting, Encoder encoder, Decoder decoder,
                std::unique_ptr<Clocks> clocks)
      : Peer(std::move(codec), std::move(setting)),
        clocks_(std::move(clocks)),
        encoder_(std::move(encoder)),
        decoder_(std::move(decoder)) {}

  Result<std::span<const std::byte>> encode(const PointCloud& cloud) override {
    return encoder_.encode(cloud, SweepInfo{});
  }

  Status decode(std::span<const std::byte> bytes, PointCloud& cloud) override {
    return decoder_.decode(bytes, cloud);
  }

  std::span<const StageTime> encode_stages() const override { return clocks_->encode.stages(); }
  std::span<const StageTime> decode_stages() const override { return clocks_->decode.stages(); }
  void forget_stages() override {
    clocks_->encode.clear();
    clocks_->decode.clear();
  }

 private:
  std::unique_ptr<Clocks> clocks_;
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
  auto clocks = std::make_unique<Clocks>();
  geometry_only.stages = &clocks->encode;
  DecoderOptions decoding = decoder;
  decoding.stages = &clocks->decode;
  auto encoder = Encoder::create(geometry_only);
  if (!encoder) return tl::unexpected(std::move(encoder.error()));
  return std::make_unique<SweepcastPeer>(std::string(name(options.codec)), std::move(setting),
                                         std::move(*encoder), Decoder(decoding), std::move(clocks));
}

}  // namespace sweepcast::lab
