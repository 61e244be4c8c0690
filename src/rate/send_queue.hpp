// What is sent next: frames wait here, layer by layer, and are cut where fresher ones come.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "rate/strategy.hpp"

namespace sweepcast {

/// A piece of a frame that is to be sent.
struct Piece {
  std::uint64_t frame = 0;  ///< as it was pushed
  std::size_t begin = 0;    ///< bytes from the start of the frame
  std::size_t bytes = 0;
};

/// The frames that are not fully sent. `oldest_first` sends all of them whole, in order.
///
/// `freshest_first` sends the newest frame first. What it overtakes is cut: a frame of which whole
/// layers are sent ends with the last of these; one of which none is keeps its first layers, as
/// many as `kLateLayers`, and they go when the newest is through, again the newest of them first.
/// A frame is given up `kLateUs` after it was pushed, but for one whose sending has begun and which
/// nothing overtook.
class SendQueue {
 public:
  static constexpr std::size_t kLateLayers = 5;
  static constexpr std::int64_t kLateUs = 1'000'000;

  explicit SendQueue(SendOrder order) : order_(order) {}

  /// Adds a frame whose layers end at these bytes, rising, at least one. Times never fall.
  void push(std::uint64_t frame, std::vector<std::size_t> layer_ends, std::int64_t now_us);

  /// Takes the next piece, at most so many bytes; none where nothing is left to send.
  [[nodiscard]] std::optional<Piece> next(std::int64_t now_us, std::size_t most_bytes);

  [[nodiscard]] std::size_t frames() const { return waiting_.size(); }
  [[nodiscard]] bool contains(std::uint64_t frame) const;
  /// Not yet taken.
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Waiting {
    std::uint64_t frame = 0;
    std::int64_t since_us = 0;
    std::size_t taken = 0;
    std::vector<std::size_t> layer_ends;
  };

  void overtake();
  void give_up(std::int64_t now_us);

  SendOrder order_;
  std::deque<Waiting> waiting_;  ///< in the order in which they go
};

}  // namespace sweepcast
