// What a stream was like: quality of experience, age, and what arrived of the sweeps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <string>

#include "lab/stream/frames.hpp"
#include "lab/stream/session.hpp"
#include "link/trace.hpp"
#include "rate/qoe.hpp"

namespace sweepcast::lab {

/// A second in which the trace offers less is an outage, bytes.
inline constexpr std::int64_t kOutageBytes = 15'000;
/// Sweeps are wanted within so much of their last firing, microseconds.
inline constexpr std::int64_t kWantedUs = 150'000;
/// How often the age is sampled, microseconds.
inline constexpr std::int64_t kAgeSampleUs = 10'000;

/// The figures of one strategy on one trace.
struct StreamSummary {
  std::string strategy;
  std::string codec;
  std::string trace;
  std::size_t sweeps = 0;
  double mean_qoe = 0.0;  ///< of a sweep
  /// Of the newest decoded sweep: now less its last firing, milliseconds; before there is one, now
  /// less the begin. Seconds of outage are left out. 0 where nothing is left.
  double age_p50_ms = 0.0, age_p95_ms = 0.0, age_p99_ms = 0.0;
  double outage_share = 0.0;     ///< of the seconds of the drive
  double delivered_150ms = 0.0;  ///< share of sweeps decoded in time, but for seconds of outage
  std::size_t dropped = 0;       ///< sweeps of which no layer arrived
  std::size_t bytes_sent = 0;
  double mean_f10 = 0.0;  ///< per cent, over all sweeps; one that never arrives counts 0
  double mean_d2 = 0.0;   ///< dB, the same
};

/// The prefixes that arrived: to be measured before `summarise`. With the ladder's own frames,
/// which tell what level a budget's frame reaches.
[[nodiscard]] std::set<FrameKey> keys_of(std::span<const SweepFate> fates, const FrameSet& frames);

/// q of a sweep: that of its level where frames are sent whole and in order; else that of the
/// finest level whose F-score it reaches; 0 where nothing of it is sent.
[[nodiscard]] double quality_of(const SweepFate& fate, const FrameSet& frames, SendOrder order);

/// Sums up. `summary` has the names already.
void summarise(std::span<const SweepFate> fates, const FrameSet& frames, const Trace& trace,
               SendOrder order, StreamSummary& summary);

}  // namespace sweepcast::lab
