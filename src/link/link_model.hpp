// A link in virtual time: what becomes of each packet, from a trace and a seed alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "link/trace.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast {

/// What a link does beside limiting the rate. Times are microseconds.
struct LinkOptions {
  std::int64_t delay_us = 0;      ///< one way, of every packet, up to a minute
  std::int64_t jitter_us = 0;     ///< further delay, uniform from 0 to this, up to a minute
  double loss = 0.0;              ///< chance that a packet is lost after it was sent, 0 to 1
  double reordering = 0.0;        ///< chance that a packet is held back and overtaken, 0 to 1
  std::int64_t held_us = 20'000;  ///< how long a held packet is late, up to a minute
  std::int64_t queue_limit = 0;   ///< bytes; a packet that finds no room is lost; 0: no limit
  std::uint64_t seed = 1;         ///< of losses, jitter and reordering
};

/// Whether a link can be made so. Errors: invalid_argument, with the option and its range.
[[nodiscard]] Status check(const LinkOptions& options);

/// A place in a trace: so many opportunities are past, and so many bytes of the next are used.
struct LinkPlace {
  std::int64_t opportunity = 0;
  std::int64_t bytes = 0;  ///< less than `kOpportunityBytes`

  [[nodiscard]] bool operator==(const LinkPlace&) const = default;
  // clang-tidy 14 mistakes the comparison with 0 for one with a pointer.
  [[nodiscard]] auto operator<=>(const LinkPlace&) const =
      default;  // NOLINT(modernize-use-nullptr)
};

/// A trace as a line that bytes move along: the rate alone, without chance. Several packets share
/// an opportunity, and one packet takes as many as it needs; what nobody uses is lost. The trace
/// must outlive it.
class TraceLine {
 public:
  explicit TraceLine(const Trace& trace) : trace_(&trace) {}

  /// The first opportunity at or after a time, microseconds, not negative.
  [[nodiscard]] LinkPlace at(std::int64_t now_us) const;
  /// The time of an opportunity, the `k`-th from the start.
  [[nodiscard]] std::int64_t time_us(std::int64_t k) const;
  /// Where the bytes end that begin at a place.
  [[nodiscard]] static LinkPlace after(LinkPlace begin, std::int64_t bytes);
  /// When the last byte before a place is sent: the time of its opportunity.
  [[nodiscard]] std::int64_t sent_us(LinkPlace end) const;

 private:
  const Trace* trace_;
};

/// What became of a packet. Times are microseconds.
struct PacketFate {
  std::int64_t sent_us = 0;                ///< when its last byte left
  std::optional<std::int64_t> arrives_us;  ///< none where it is lost
};

/// A link that carries packets one after the other. Same trace, options and packets, same fates.
/// The trace must outlive it. Packets keep their order but for those held back.
class LinkModel {
 public:
  /// The options must pass `check`.
  LinkModel(const Trace& trace, const LinkOptions& options);

  /// Takes a packet of so many bytes, above 0, at a time no less than the time before.
  /// None where the queue has no room for it.
  [[nodiscard]] std::optional<PacketFate> send(std::int64_t now_us, std::int64_t bytes);

  /// Bytes that were taken and are not yet sent.
  [[nodiscard]] std::int64_t queued_bytes(std::int64_t now_us) const;

 private:
  [[nodiscard]] double random();

  TraceLine line_;
  LinkOptions options_;
  LinkPlace end_;                     ///< of what was taken
  std::int64_t last_arrival_us_ = 0;  ///< of packets that were not held back
  std::uint64_t random_state_;
};

}  // namespace sweepcast
