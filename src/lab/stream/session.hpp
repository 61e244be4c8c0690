// A stream of sweeps over a link, in virtual time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "lab/stream/frames.hpp"
#include "link/link_model.hpp"
#include "rate/strategy.hpp"

namespace sweepcast::lab {

/// Bytes of a packet at most.
inline constexpr std::size_t kPacketBytes = 1400;

struct SessionOptions {
  LinkOptions link;         ///< `queue_limit`: frames that would make the queue longer are dropped
  std::size_t sweeps = 0;   ///< the set's, over and over
  double rate_hz = 10.0;    ///< sweep i has its last firing at (i + 1) / rate
  int model_interval = 10;  ///< every how many sweeps the sensor's model is sent
};

/// What became of one sweep. Times are microseconds from the start of the drive.
struct SweepFate {
  std::int64_t ready_us = 0;      ///< its last firing, at which it is encoded
  FrameKey sent;                  ///< what it was encoded as; `layers`: those that arrived, maybe 0
  bool skipped = false;           ///< at the strategy's wish, or for want of room in the queue
  std::size_t queued_frames = 0;  ///< before it, not fully sent
  std::size_t queued_bytes = 0;   ///< the same
  std::size_t bytes = 0;          ///< sent, those twice that were lost
  std::int64_t decoded_us = 0;    ///< when the last layer that arrived did; 0 where none
};

/// Runs a strategy over a link. A packet that is lost is sent again when the receiver's word of it
/// has come: a round trip after it was sent. Same arguments, same fates.
[[nodiscard]] std::vector<SweepFate> run_session(const FrameSet& frames, const Trace& trace,
                                                 const SessionOptions& options, Strategy& strategy);

}  // namespace sweepcast::lab
