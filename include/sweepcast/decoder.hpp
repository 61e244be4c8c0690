// The decoder: frames in, clouds out.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "sweepcast/cloud.hpp"
#include "sweepcast/frame.hpp"
#include "sweepcast/stages.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast {

/// What a decoder does. A frame that asks for more points is refused before any allocation.
struct DecoderOptions {
  std::size_t max_points = std::size_t{1} << 24;
  int max_layers = 64;  ///< codec beam: decode only this many layers, coarsest first
  /// Codec beam: points that were left out because interpolation comes near them are appended as
  /// it has them, marked in `PointCloud::filled`; their other attributes are 0.
  bool fill = false;
  StageClock* stages = nullptr;  ///< learns what each stage takes, where there is one
};

/// Makes clouds of frames. Needs no parameter beside the frame and trusts nothing in it.
/// Keeps its buffers: decoding frames of a kind allocates nothing from the second on. One thread
/// at a time may use a decoder; different decoders share nothing.
class Decoder {
 public:
  explicit Decoder(const DecoderOptions& options = {});
  Decoder(Decoder&&) noexcept;
  Decoder& operator=(Decoder&&) noexcept;
  ~Decoder();

  /// Decodes one whole frame into `cloud`, whose memory is reused; columns that the frame does not
  /// carry come back empty. Codec rcpcc: points come row by row from the lowest, each row by
  /// azimuth. Codec beam: firing by firing, each from the highest beam down, points without a cell
  /// last; or in the original order where the frame has it and all its layers are decoded. On error
  /// `cloud` is empty.
  /// Errors: truncated, corrupt, unsupported, limit.
  [[nodiscard]] Status decode(std::span<const std::byte> frame, PointCloud& cloud);

  /// The head of the last frame that was decoded.
  [[nodiscard]] const FrameHeader& last_header() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sweepcast
