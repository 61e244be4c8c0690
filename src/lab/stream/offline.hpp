// The best that any strategy could have done, had it known the trace: the limit for the others.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "lab/stream/frames.hpp"
#include "lab/stream/session.hpp"
#include "link/trace.hpp"
#include "rate/strategy.hpp"

namespace sweepcast::lab {

/// What is done with each sweep.
using Plan = std::vector<Choice>;

/// The plan with the largest QoE (equation 5) of all that send frames whole and in order or leave
/// sweeps out, over a link that loses nothing and whose queue has no limit. Choices are the levels
/// of the ladder and the byte budgets, whose frames must have been measured whole.
///
/// Dynamic programming over the sweeps. In a queue that is served in order, a frame's share in all
/// the K that follow is known when it is encoded: the number of sweeps that come before it is fully
/// sent. So a state is where the queue ends in the trace, and the quality before; of two states
/// with the same quality, one whose queue ends no later and whose QoE is no less makes the other
/// needless, and so does one of another quality whose QoE is no less after a change to this one.
[[nodiscard]] Plan plan_offline(const FrameSet& frames, const Trace& trace,
                                const SessionOptions& options);

/// A strategy that follows a plan.
[[nodiscard]] std::unique_ptr<Strategy> make_planned(Plan plan);

}  // namespace sweepcast::lab
