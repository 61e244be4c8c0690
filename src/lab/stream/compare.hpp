// Strategies side by side over the same link and sweeps.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lab/stream/frames.hpp"
#include "lab/stream/session.hpp"
#include "lab/stream/summary.hpp"
#include "link/trace.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// The limit, beside the names of `make_strategy`; see `plan_offline`.
inline constexpr std::string_view kOffline = "offline";

struct StreamComparison {
  CodecId codec = CodecId::beam;
  std::vector<std::string> strategies;  ///< names
  SessionOptions session;
  OnSweep on_encoded;   ///< called after each sweep
  OnSweep on_measured;  ///< called after each frame
};

/// One strategy's stream.
struct Stream {
  StreamSummary summary;
  std::vector<SweepFate> fates;
  std::vector<QoeSweep> qoe;          ///< [sweep]
  std::vector<SweepQuality> quality;  ///< [sweep], as it arrived; zeros where nothing did
};

/// Encodes, streams and measures. Errors: those of `FrameMaker` and `make_strategy`;
/// invalid_argument (no sweep; a link that cannot be).
[[nodiscard]] Result<std::vector<Stream>> compare_streams(
    std::span<const std::filesystem::path> sweeps, const Trace& trace,
    const StreamComparison& comparison);

}  // namespace sweepcast::lab
