// Codecs side by side on the same sweeps: ratio, distortion and time.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lab/distortion.hpp"
#include "lab/peers/peer.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// What a stage of a codec takes of a sweep.
struct StageMean {
  std::string stage;
  double ms = 0;  ///< by the clock, mean over the sweeps and the timed runs
};

/// A codec at one setting, mean over the sweeps.
struct BenchRow {
  std::string codec;
  std::string setting;
  double ratio = 0;          ///< 16 bytes a point over the bytes, as the paper counts
  double bytes = 0;          ///< of an encoded sweep
  double points_in = 0;      ///< of a sweep
  double points_out = 0;     ///< of a decoded sweep
  double points_filled = 0;  ///< of these, not measured but interpolated by the decoder
  Distortion distortion;
  /// CPU time of one thread, and of programs that the codec runs; of each sweep the median over
  /// the runs.
  double encode_ms = 0;
  double decode_ms = 0;                                 ///< the same
  std::vector<StageMean> encode_stages, decode_stages;  ///< of codecs that tell them
};

struct BenchOptions {
  int runs = 5;  ///< timed repetitions of each sweep, at least 1; one more before them is not timed
  std::function<void(std::string_view)> on_sweep{};  ///< called after each sweep with its name
};

/// Measures every peer on every sweep. The peers take turns within each run, so that a machine
/// whose speed drifts does so for all of them. Rows come in the order of `peers`.
/// Errors: those of `read_cloud` and of the peers, naming the file; invalid_argument (no sweep).
[[nodiscard]] Result<std::vector<BenchRow>> bench(std::span<const std::filesystem::path> sweeps,
                                                  const Peers& peers, const BenchOptions& options);

}  // namespace sweepcast::lab
