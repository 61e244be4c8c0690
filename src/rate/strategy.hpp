// Bitrate strategies: what the next sweep may cost, from what the sender has seen of the link.
// No clock and no socket: the sender tells the time, so that the same code runs in virtual time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "rate/qoe.hpp"
#include "sweepcast/frame.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast {

/// What a sender knows at the instant at which a sweep is to be encoded.
struct LinkView {
  double period_s = 0.1;  ///< to the next sweep
  double delay_s = 0.0;   ///< one way, from a packet's sending to its arrival, at worst as a rule
  /// Frames encoded before and not fully sent, those given up not among them.
  std::size_t queued_frames = 0;
  std::size_t queued_bytes = 0;  ///< of these, not yet sent
  /// Sent before and not known to have arrived, more than the link holds as a rule: nothing
  /// overtakes these.
  std::size_t ahead_bytes = 0;
  /// Bytes that the link took since the sweep before.
  std::size_t sent_bytes = 0;
  /// Of the time since then, seconds in which there was something to send.
  double busy_s = 0.0;
  /// What a frame takes at each level as a rule, finest first, bytes.
  std::span<const std::size_t> level_bytes;
};

/// How to encode the sweep: at a level of the codec's ladder, or else as good as fits `bytes`. A
/// codec without a budget takes the finest level that fits as a rule, or its coarsest.
struct Choice {
  std::optional<std::size_t> level{};
  std::size_t bytes = 0;
  bool skip = false;  ///< the sweep is not sent at all
};

/// What is sent first.
enum class SendOrder : std::uint8_t {
  oldest_first,    ///< a queue: every frame is sent, whole
  freshest_first,  ///< see `SendQueue`
};

/// The level with the largest value, of equal ones the finest; `value` maps 0 to levels - 1.
template <class Value>
[[nodiscard]] std::size_t best_level(std::size_t levels, const Value& value) {
  std::size_t best = 0;
  auto most = value(best);
  for (std::size_t level = 1; level < levels; ++level) {
    const auto worth = value(level);
    if (worth <= most) continue;
    best = level;
    most = worth;
  }
  return best;
}

/// A strategy is called once for each sweep, in order.
class Strategy {
 public:
  Strategy() = default;
  virtual ~Strategy() = default;
  Strategy(const Strategy&) = delete;
  Strategy& operator=(const Strategy&) = delete;

  [[nodiscard]] virtual Choice decide(const LinkView& view) = 0;
  [[nodiscard]] virtual SendOrder order() const { return SendOrder::oldest_first; }
};

/// The same level always.
[[nodiscard]] std::unique_ptr<Strategy> make_fixed(std::size_t level);
/// The RCPCC paper's, section III.C: by the length of the queue alone.
[[nodiscard]] std::unique_ptr<Strategy> make_paper();
/// BOLA (Spiteri, Urgaonkar, Sitaraman 2016), with the room in the queue as its buffer.
[[nodiscard]] std::unique_ptr<Strategy> make_bola();
/// RobustMPC (Yin, Jindal, Sekar, Sinopoli 2015) with the paper's QoE as its aim.
[[nodiscard]] std::unique_ptr<Strategy> make_mpc();
/// Ours: a byte budget a sweep, the freshest first; for codecs that fit a frame to a size and whose
/// frames have layers.
[[nodiscard]] std::unique_ptr<Strategy> make_budget();
/// Ours for the other codecs: levels planned ahead for the estimated rate, with the paper's QoE as
/// its aim; see `LadderPlan`.
[[nodiscard]] std::unique_ptr<Strategy> make_planned_levels();

/// Names that `make_strategy` knows beside "fixed:L".
inline constexpr std::string_view kStrategyNames = "budget, paper, bola, mpc, fixed:0 to fixed:5";

/// A strategy by its name; "budget" is `make_budget` for codec beam, else `make_planned_levels`.
/// Errors: invalid_argument, with the names that there are.
[[nodiscard]] Result<std::unique_ptr<Strategy>> make_strategy(std::string_view name, CodecId codec);

}  // namespace sweepcast
