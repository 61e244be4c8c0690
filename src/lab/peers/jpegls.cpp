#include "lab/peers/jpegls.hpp"

#include <charls/charls.h>
#include <fmt/core.h>

#include <array>
#include <exception>
#include <string>
#include <utility>

namespace sweepcast::lab {
namespace {

Status failed(ErrorCode code, const std::exception& error) {
  return fail(code, std::string("jpegls: ") + error.what());
}

class JpeglsCoder : public ImageCoder {
 public:
  explicit JpeglsCoder(int near) : near_(near) {}

  Status encode(std::span<const std::uint16_t> pixels, std::size_t columns,
                std::vector<std::byte>& out) override {
    try {
      charls::jpegls_encoder encoder;
      encoder.frame_info(frame_of(pixels.size(), columns)).near_lossless(near_);
      const std::size_t begin = out.size();
      out.resize(begin + encoder.estimated_destination_size());
      encoder.destination(out.data() + begin, out.size() - begin);
      out.resize(begin + encoder.encode(pixels.data(), pixels.size_bytes()));
      return {};
    } catch (const std::exception& error) {
      return failed(ErrorCode::limit, error);
    }
  }

  Status decode(std::span<const std::byte> bytes, std::size_t columns,
                std::span<std::uint16_t> pixels) override {
    try {
      charls::jpegls_decoder decoder;
      decoder.source(bytes.data(), bytes.size()).read_header();
      const charls::frame_info expected = frame_of(pixels.size(), columns);
      const charls::frame_info& found = decoder.frame_info();
      if (found.width != expected.width || found.height != expected.height ||
          found.bits_per_sample != expected.bits_per_sample ||
          found.component_count != expected.component_count) {
        return fail(ErrorCode::corrupt, "jpegls: the picture is not as large as the frame says");
      }
      decoder.decode(pixels.data(), pixels.size_bytes());
      return {};
    } catch (const std::exception& error) {
      return failed(ErrorCode::corrupt, error);
    }
  }

 private:
  static charls::frame_info frame_of(std::size_t pixels, std::size_t columns) {
    return {static_cast<std::uint32_t>(columns), static_cast<std::uint32_t>(pixels / columns), 16,
            1};
  }

  int near_;
};

}  // namespace

Result<std::unique_ptr<Peer>> make_jpegls_peer(const JpeglsOptions& options) {
  if (Status form = check(options.form); !form) return tl::unexpected(form.error());
  if (!options.form.beam_aligned) {
    return fail(ErrorCode::invalid_argument, "jpegls: only beam-aligned images, with a mask");
  }
  if (options.near < 0 || options.near > 255) {
    return fail(ErrorCode::invalid_argument, "jpegls: near must be from 0 to 255");
  }
  return make_range_image_peer("jpegls-range",
                               fmt::format("{}, near {}", name(options.form), options.near),
                               options.form, std::make_unique<JpeglsCoder>(options.near));
}

Result<Peers> jpegls_ladder() {
  struct Rung {
    std::size_t columns;
    int near;
  };
  static constexpr std::array<Rung, 10> kRungs{{{4096, 1},
                                                {4096, 5},
                                                {2048, 5},
                                                {2048, 12},
                                                {2048, 25},
                                                {1024, 25},
                                                {1024, 50},
                                                {1024, 125},
                                                {512, 100},
                                                {512, 250}}};
  return make_ladder(kRungs, [](const Rung& rung) {
    JpeglsOptions options;
    options.form.columns = rung.columns;
    options.near = rung.near;
    return make_jpegls_peer(options);
  });
}

}  // namespace sweepcast::lab
