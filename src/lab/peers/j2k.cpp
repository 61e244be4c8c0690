#include "lab/peers/j2k.hpp"

#include <fmt/core.h>
#include <openjpeg.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

namespace sweepcast::lab {
namespace {

template <auto Function>
struct Call {
  template <class T>
  void operator()(T* object) const {
    Function(object);
  }
};
using Codec = std::unique_ptr<opj_codec_t, Call<opj_destroy_codec>>;
using Stream = std::unique_ptr<opj_stream_t, Call<opj_stream_destroy>>;
using Image = std::unique_ptr<opj_image_t, Call<opj_image_destroy>>;

constexpr auto kEnd = static_cast<OPJ_SIZE_T>(-1);  // what a stream's functions give at an end

/// Bytes that OpenJPEG reads.
struct Source {
  std::span<const std::byte> bytes;
  std::size_t at = 0;

  static OPJ_SIZE_T read(void* buffer, OPJ_SIZE_T size, void* source) {
    auto& self = *static_cast<Source*>(source);
    const std::size_t count = std::min(size, self.bytes.size() - self.at);
    if (count == 0) return kEnd;
    std::memcpy(buffer, self.bytes.data() + self.at, count);
    self.at += count;
    return count;
  }
  static OPJ_OFF_T skip(OPJ_OFF_T size, void* source) {
    auto& self = *static_cast<Source*>(source);
    const auto rest = static_cast<OPJ_OFF_T>(self.bytes.size() - self.at);
    if (size < 0 || rest == 0) return -1;
    const OPJ_OFF_T count = std::min(size, rest);
    self.at += static_cast<std::size_t>(count);
    return count;
  }
  static OPJ_BOOL seek(OPJ_OFF_T at, void* source) {
    auto& self = *static_cast<Source*>(source);
    if (at < 0 || static_cast<std::size_t>(at) > self.bytes.size()) return OPJ_FALSE;
    self.at = static_cast<std::size_t>(at);
    return OPJ_TRUE;
  }
};

/// Bytes that OpenJPEG writes, from its first on.
struct Sink {
  std::vector<std::byte> bytes;
  std::size_t at = 0;

  static OPJ_SIZE_T write(void* buffer, OPJ_SIZE_T size, void* sink) {
    auto& self = *static_cast<Sink*>(sink);
    self.bytes.resize(std::max(self.bytes.size(), self.at + size));
    std::memcpy(self.bytes.data() + self.at, buffer, size);
    self.at += size;
    return size;
  }
  static OPJ_OFF_T skip(OPJ_OFF_T size, void* sink) {
    auto& self = *static_cast<Sink*>(sink);
    if (size < 0) return -1;
    self.at += static_cast<std::size_t>(size);
    return size;
  }
  static OPJ_BOOL seek(OPJ_OFF_T at, void* sink) {
    if (at < 0) return OPJ_FALSE;
    static_cast<Sink*>(sink)->at = static_cast<std::size_t>(at);
    return OPJ_TRUE;
  }
};

/// Keeps OpenJPEG's first error, without its line's end.
void keep_message(const char* message, void* text) {
  auto& kept = *static_cast<std::string*>(text);
  if (!kept.empty()) return;
  kept = message;
  while (!kept.empty() && kept.back() == '\n') kept.pop_back();
}

Status failed(ErrorCode code, const std::string& message) {
  return fail(code, "j2k: " + (message.empty() ? "OpenJPEG gave no reason" : message));
}

Image make_image(std::span<const std::uint16_t> pixels, std::size_t columns) {
  opj_image_cmptparm_t component{};
  component.dx = component.dy = 1;
  component.w = static_cast<OPJ_UINT32>(columns);
  component.h = static_cast<OPJ_UINT32>(pixels.size() / columns);
  component.prec = 16;
  Image image(opj_image_create(1, &component, OPJ_CLRSPC_GRAY));
  if (!image) return image;
  image->x1 = component.w;
  image->y1 = component.h;
  std::copy(pixels.begin(), pixels.end(), image->comps[0].data);
  return image;
}

class J2kCoder : public ImageCoder {
 public:
  explicit J2kCoder(double rate) : rate_(rate) {}

  Status encode(std::span<const std::uint16_t> pixels, std::size_t columns,
                std::vector<std::byte>& out) override {
    std::string message;
    const Image image = make_image(pixels, columns);
    const Codec codec(opj_create_compress(OPJ_CODEC_J2K));
    Sink sink;
    const Stream stream(opj_stream_default_create(OPJ_FALSE));
    if (!image || !codec || !stream) return failed(ErrorCode::limit, "out of memory");
    opj_set_error_handler(codec.get(), keep_message, &message);
    opj_stream_set_user_data(stream.get(), &sink, nullptr);
    opj_stream_set_write_function(stream.get(), Sink::write);
    opj_stream_set_skip_function(stream.get(), Sink::skip);
    opj_stream_set_seek_function(stream.get(), Sink::seek);
    opj_cparameters_t parameters = parameters_for(pixels.size() / columns, columns);
    if (opj_setup_encoder(codec.get(), &parameters, image.get()) == OPJ_FALSE ||
        opj_start_compress(codec.get(), image.get(), stream.get()) == OPJ_FALSE ||
        opj_encode(codec.get(), stream.get()) == OPJ_FALSE ||
        opj_end_compress(codec.get(), stream.get()) == OPJ_FALSE) {
      return failed(ErrorCode::limit, message);
    }
    out.insert(out.end(), sink.bytes.begin(), sink.bytes.end());
    return {};
  }

  Status decode(std::span<const std::byte> bytes, std::size_t columns,
                std::span<std::uint16_t> pixels) override {
    std::string message;
    Source source{bytes};
    const Codec codec(opj_create_decompress(OPJ_CODEC_J2K));
    const Stream stream(opj_stream_default_create(OPJ_TRUE));
    if (!codec || !stream) return failed(ErrorCode::limit, "out of memory");
    opj_set_error_handler(codec.get(), keep_message, &message);
    opj_stream_set_user_data(stream.get(), &source, nullptr);
    opj_stream_set_user_data_length(stream.get(), bytes.size());
    opj_stream_set_read_function(stream.get(), Source::read);
    opj_stream_set_skip_function(stream.get(), Source::skip);
    opj_stream_set_seek_function(stream.get(), Source::seek);
    opj_dparameters_t parameters{};
    opj_set_default_decoder_parameters(&parameters);
    if (opj_setup_decoder(codec.get(), &parameters) == OPJ_FALSE) {
      return failed(ErrorCode::limit, message);
    }
    opj_image_t* read = nullptr;
    const bool has_header = opj_read_header(stream.get(), codec.get(), &read) != OPJ_FALSE;
    const Image image(read);
    if (!has_header || !image) return failed(ErrorCode::corrupt, message);
    if (!fits(*image, columns, pixels.size() / columns)) {
      return failed(ErrorCode::corrupt, "the picture is not as large as the frame says");
    }
    if (opj_decode(codec.get(), stream.get(), image.get()) == OPJ_FALSE ||
        !fits(*image, columns, pixels.size() / columns) || image->comps[0].data == nullptr) {
      return failed(ErrorCode::corrupt, message);
    }
    std::transform(image->comps[0].data, image->comps[0].data + pixels.size(), pixels.begin(),
                   [](OPJ_INT32 value) {
                     return static_cast<std::uint16_t>(std::clamp<OPJ_INT32>(value, 0, 65535));
                   });
    return {};
  }

 private:
  [[nodiscard]] opj_cparameters_t parameters_for(std::size_t rows, std::size_t columns) const {
    opj_cparameters_t parameters{};
    opj_set_default_encoder_parameters(&parameters);
    parameters.tcp_numlayers = 1;
    parameters.cp_disto_alloc = 1;
    parameters.tcp_rates[0] = static_cast<float>(rate_);
    parameters.irreversible = 1;
    // A transform may halve the shorter side no more often than it has bits.
    const auto bits = static_cast<int>(std::bit_width(std::min(rows, columns)));
    parameters.numresolution = std::clamp(bits, 1, 6);
    return parameters;
  }

  /// Whether the picture is of one component of 16 bits and of this size: asked of the header,
  /// before anything of that size is allocated, and of what was decoded.
  [[nodiscard]] static bool fits(const opj_image_t& image, std::size_t columns, std::size_t rows) {
    if (image.numcomps != 1 || image.x0 != 0 || image.y0 != 0 || image.x1 != columns ||
        image.y1 != rows) {
      return false;
    }
    const opj_image_comp_t& component = image.comps[0];
    return component.dx == 1 && component.dy == 1 && component.w == columns &&
           component.h == rows && component.prec == 16 && component.sgnd == 0;
  }

  double rate_;
};

/// A rung of a ladder.
struct Rung {
  std::size_t columns;
  double rate;
};

Result<Peers> ladder(std::span<const Rung> rungs, bool beam_aligned) {
  return make_ladder(rungs, [beam_aligned](const Rung& rung) {
    J2kOptions options;
    options.form.columns = rung.columns;
    options.form.beam_aligned = beam_aligned;
    options.rate = rung.rate;
    return make_j2k_peer(options);
  });
}

}  // namespace

Result<std::unique_ptr<Peer>> make_j2k_peer(const J2kOptions& options) {
  if (Status form = check(options.form); !form) return tl::unexpected(form.error());
  if (!(options.rate >= 1.0 && options.rate <= 1000.0)) {
    return fail(ErrorCode::invalid_argument, "j2k: the rate must be from 1 to 1000");
  }
  return make_range_image_peer(options.form.beam_aligned ? "j2k-range" : "j2k-range-naive",
                               fmt::format("{}, rate {}", name(options.form), options.rate),
                               options.form, std::make_unique<J2kCoder>(options.rate));
}

Result<Peers> j2k_ladder() {
  static constexpr std::array<Rung, 11> kRungs{{{4096, 2.5},
                                                {2048, 2.5},
                                                {2048, 4},
                                                {2048, 6},
                                                {2048, 8},
                                                {1024, 6},
                                                {1024, 8},
                                                {1024, 12},
                                                {1024, 20},
                                                {512, 10},
                                                {512, 16}}};
  return ladder(kRungs, true);
}

Result<Peers> j2k_naive_ladder() {
  static constexpr std::array<Rung, 8> kRungs{{{2048, 1.5},
                                               {2048, 3},
                                               {2048, 5},
                                               {2048, 10},
                                               {2048, 15},
                                               {2048, 20},
                                               {2048, 30},
                                               {2048, 50}}};
  return ladder(kRungs, false);
}

}  // namespace sweepcast::lab
