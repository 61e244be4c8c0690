// Codecs of pictures as peers: a sweep becomes a range image, which the codec takes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lab/peers/peer.hpp"
#include "lab/peers/range_raster.hpp"

namespace sweepcast::lab {

/// A codec of grey pictures of 16 bits a pixel, at one setting.
class ImageCoder {
 public:
  ImageCoder() = default;
  virtual ~ImageCoder() = default;
  ImageCoder(const ImageCoder&) = delete;
  ImageCoder& operator=(const ImageCoder&) = delete;

  /// Appends the picture, rows of `columns`, to `out`.
  [[nodiscard]] virtual Status encode(std::span<const std::uint16_t> pixels, std::size_t columns,
                                      std::vector<std::byte>& out) = 0;

  /// Fills a picture of just this size. Bytes of any other, or damaged ones, are an error.
  [[nodiscard]] virtual Status decode(std::span<const std::byte> bytes, std::size_t columns,
                                      std::span<std::uint16_t> pixels) = 0;
};

/// What the picture is.
struct RangeImageForm {
  std::size_t columns = 2048;
  /// A row for each beam, and a coded mask of which cells hold a point; else what is usually done:
  /// 64 rows at equal angles, zeros where there is no point, and no mask: what decodes to less than
  /// 2 m is taken for none.
  bool beam_aligned = true;
};

inline constexpr double kNaiveNearest = 2.0;  ///< metres; of the form without a mask

/// As in "beams x 2048" or "64 x 2048".
[[nodiscard]] std::string name(const RangeImageForm& form);

/// Makes a peer of a codec of pictures. Its rows are those of the first sweep that it encodes (the
/// sensor does not change) and are part of every frame, as is a checksum of 4 bytes: what
/// libraries of pictures make of damage is not tested here, and may take minutes. A point is lost
/// where another, nearer one has its cell.
[[nodiscard]] std::unique_ptr<Peer> make_range_image_peer(std::string codec, std::string setting,
                                                          const RangeImageForm& form,
                                                          std::unique_ptr<ImageCoder> coder);

/// Whether columns are within bounds: 16 to 65536. Error: invalid_argument.
[[nodiscard]] Status check(const RangeImageForm& form);

}  // namespace sweepcast::lab
