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
/// `freshest_first` sends the newest frame first, its layers in order, and cuts what it overtakes:
/// - A frame of which whole layers are taken ends with the last of these.
/// - One that is in its first layer, and not older than `kFinishUs`, goes on to that layer's end
///   before the newest begins: else, where a layer takes longer than the time between sweeps, none
///   would ever be through.
/// - Of others the first `kLateLayers` layers wait until nothing fresher is left to send, the
/// newest
///   of them first, and are given up `kLateUs` after they were pushed.
class SendQueue {
 public:
  static constexpr std::int64_t kFinishUs = 200'000;
  static constexpr std::size_t kLateLayers = 3;
  static constexpr std::int64_t kLateUs = 60'000'000;

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

  static bool finishes_layer(const Waiting& waiting, std::int64_t now_us);
  void overtake(bool finishes_first);
  void give_up(std::int64_t now_us);

  SendOrder order_;
  std::deque<Waiting> waiting_;  ///< in the order in which they go
};

}  // namespace sweepcast
