// One codec at one setting over a whole drive: its bytes and times, and what the tasks make of it.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lab/evaluate/drive.hpp"
#include "lab/evaluate/task.hpp"
#include "lab/peers/peer.hpp"

namespace sweepcast::lab {

/// Bytes and times of a codec at one setting, over all sweeps.
struct Coding {
  double ratio = 0.0;  ///< 16 bytes a point that came in, over all bytes
  double bytes = 0.0;  ///< of a sweep, mean
  double encode_ms =
      0.0;  ///< CPU time of a sweep, mean, once; programs that the codec runs counted
  double decode_ms = 0.0;  ///< the same
  /// Mean bytes of each part of our frames, the head as "header", layers numbered; empty for other
  /// codecs.
  std::map<std::string, double> parts;
  std::string picture;  ///< of the drive's middle sweep as it was decoded, a PNG file in base64
};

/// What came of a task: its figures, or why there are none.
using TaskOutcome = Result<Figures>;

struct Measurement {
  Coding coding;
  std::vector<TaskOutcome> outcomes;  ///< of each task
};

/// Encodes and decodes every sweep in order and gives it to the tasks, a sweep at a time.
/// `on_sweep` is called after each. A task that fails costs itself alone.
/// Errors: those of `read_cloud` and of the codec, naming the file.
[[nodiscard]] Result<Measurement> measure(const DriveFiles& drive, Peer& peer,
                                          std::span<const Task* const> tasks,
                                          const std::function<void()>& on_sweep);

}  // namespace sweepcast::lab
