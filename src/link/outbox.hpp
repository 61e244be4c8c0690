// What a sender holds: the bytes of the frames in its queue, as the fragments that leave next.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "link/fragment.hpp"
#include "link/qoe_meter.hpp"
#include "rate/send_queue.hpp"

namespace sweepcast::link {

/// `SendQueue` decides what goes; this has the bytes. A fragment never reaches beyond its layer.
class Outbox {
 public:
  explicit Outbox(SendOrder order) : queue_(order) {}

  /// Queues a sweep as stream `stream`'s next. `layers`: not empty, none of them empty. `level`: of
  /// the ladder, that it was encoded at; none where it is no such level's.
  void push(std::uint8_t stream, std::vector<std::vector<std::byte>> layers, Microseconds deadline,
            Microseconds now, std::optional<std::size_t> level = {});

  /// The next fragment to send; its payload is valid until the outbox changes. None where nothing
  /// waits. Drops what is over at `now`.
  [[nodiscard]] std::optional<Fragment> peek(Microseconds now);
  /// Counts the fragment that `peek` gave as sent.
  void pop();

  /// Drops everything, as when the connection is lost.
  void clear();

  [[nodiscard]] const SendQueue& queue() const { return queue_; }

  /// See `SenderReport::qoe`; a mean over the streams that have one.
  [[nodiscard]] std::optional<double> qoe();

 private:
  struct Sweep {
    std::uint8_t stream = 0;
    std::uint32_t number = 0;
    Microseconds deadline = 0;
    std::vector<std::vector<std::byte>> layers;
    std::optional<std::size_t> level;
    std::size_t queued = 0;  ///< of its stream before it, not fully sent
    std::size_t left = 0;    ///< bytes
  };
  void settle();

  SendQueue queue_;
  std::map<std::uint64_t, Sweep> sweeps_;  ///< those in the queue, and maybe some that were
  std::uint64_t last_ = 0;
  std::array<std::uint32_t, kMostStreams> last_numbers_{};
  std::uint64_t peeked_ = 0;  ///< the frame that `peek` told of
  std::size_t peeked_bytes_ = 0;
  std::array<QoeMeter, kMostStreams> qoe_;
};

}  // namespace sweepcast::link
