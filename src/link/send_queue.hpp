// What waits to be sent: of each sensor the freshest sweep, layers in order, coarsest first.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "link/fragment.hpp"

namespace sweepcast::link {

/// What became of sweeps.
struct SendCounts {
  std::uint64_t sent = 0;     ///< all layers left
  std::uint64_t cut = 0;      ///< at least one layer left whole, but not all
  std::uint64_t dropped = 0;  ///< none did
};

/// Chooses the next fragment. A newer sweep ends an older one of its stream after the layer at
/// hand, so that something whole leaves however slow the link is; what has not begun is dropped. At
/// its deadline a sweep ends where it is.
class SendQueue {
 public:
  /// Queues a sweep as stream `stream`'s next. `layers`: not empty, none of them empty.
  void push(std::uint8_t stream, std::vector<std::vector<std::byte>> layers, Microseconds deadline);

  /// The next fragment to send; its payload is valid until the queue changes. None where nothing
  /// waits. Drops what is over at `now`.
  [[nodiscard]] std::optional<Fragment> peek(Microseconds now);
  /// Counts the fragment that `peek` gave as sent.
  void pop();

  /// Drops everything, as when the connection is lost.
  void clear();

  [[nodiscard]] bool empty() const;
  [[nodiscard]] std::size_t queued_bytes() const;
  [[nodiscard]] const SendCounts& counts() const { return counts_; }

 private:
  struct Sweep {
    std::uint32_t number = 0;
    std::vector<std::vector<std::byte>> layers;
    Microseconds deadline = 0;
    std::size_t layer = 0;     ///< to send next
    std::size_t fragment = 0;  ///< of it
    std::size_t end = 0;       ///< layers that are to be sent
  };
  struct Stream {
    std::uint32_t last_number = 0;
    std::optional<Sweep> sweep, next;
  };

  void finish(Stream& stream);

  std::array<Stream, kMostStreams> streams_;
  std::uint8_t turn_ = 0;  ///< stream of the fragment that `peek` gave
  SendCounts counts_;
};

}  // namespace sweepcast::link
