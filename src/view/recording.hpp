// Recordings to look at: any frame of them by its number, ready to be decoded alone.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sweepcast/cloud.hpp"
#include "sweepcast/encoder.hpp"
#include "sweepcast/status.hpp"
#include "view/sweep.hpp"

namespace sweepcast::view {

/// Frames in an order. One thread at a time may use it.
class Recording {
 public:
  virtual ~Recording() = default;

  [[nodiscard]] virtual std::uint32_t size() const = 0;
  [[nodiscard]] virtual std::vector<Stream> streams() const = 0;
  /// The stream that frame `index` belongs to; `index` is below `size()`.
  [[nodiscard]] virtual std::uint8_t stream_of(std::uint32_t index) const = 0;
  [[nodiscard]] virtual bool has_original(std::uint32_t index) const = 0;

  /// Frame `index`; those that were asked for lately are at hand.
  /// Errors: invalid_argument (no such frame), those of reading, and corrupt, truncated: the frame
  /// is damaged. Messages name file and frame.
  [[nodiscard]] Result<SharedSweep> sweep(std::uint32_t index);

  /// The cloud that the frame was made from. Errors: not_found, those of `read_cloud`.
  [[nodiscard]] virtual Status original(std::uint32_t index, PointCloud& cloud) = 0;

 private:
  static constexpr std::size_t kMostKept = std::size_t{32} << 20;  ///< bytes

  [[nodiscard]] virtual Result<SharedSweep> make(std::uint32_t index) = 0;

  std::deque<SharedSweep> kept_;  ///< the newest last
  std::size_t kept_bytes_ = 0;
};

/// Opens .sweep files, one after the other, each a stream of its own, named after the file and its
/// folder. `originals`: clouds to compare with, found by the name of the frame's source, or by
/// number where it has none.
/// Errors: those of `SweepReader::open`; invalid_argument (no frame), limit (over 256 files).
[[nodiscard]] Result<std::unique_ptr<Recording>> open_sweep_files(
    const std::vector<std::filesystem::path>& files,
    const std::vector<std::filesystem::path>& originals);

/// Clouds, encoded when they are asked for: each frame has its sensor's model. They are their own
/// originals. Errors: those of `Encoder::create`.
[[nodiscard]] Result<std::unique_ptr<Recording>> open_clouds(
    std::vector<std::filesystem::path> clouds, EncoderOptions options, double rate_hz);

}  // namespace sweepcast::view
