// Where the sweeps of `send` come from: clouds, a .sweep file, or a .sweep stream on standard
// input.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "sweepcast/cloud.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::app {

/// One sweep: a frame, or, where that is empty, a cloud that is still to be encoded.
struct SourceSweep {
  std::string name;  ///< of its source, without extension
  std::vector<std::byte> frame;
  PointCloud cloud;
};

class SweepSource {
 public:
  virtual ~SweepSource() = default;

  /// The next sweep, into `sweep`, whose memory is reused. False where there is none, or where a
  /// signal asked to stop while standard input kept us waiting.
  /// Errors: those of reading clouds and .sweep files, with the file's name.
  [[nodiscard]] virtual Result<bool> next(SourceSweep& sweep) = 0;
  /// Begins anew. False where that is impossible, as on standard input.
  [[nodiscard]] virtual bool rewind() = 0;
  /// Whether `next` gives clouds.
  [[nodiscard]] virtual bool gives_clouds() const = 0;
};

/// Opens a folder or cloud, a file whose name ends in .sweep, or "-".
/// Errors: those of `collect_clouds` and of `SweepReader::open`; invalid_argument (a .sweep file
/// without a frame).
[[nodiscard]] Result<std::unique_ptr<SweepSource>> open_source(const std::string& input);

}  // namespace sweepcast::app
