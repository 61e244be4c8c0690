// What is sent next: frames wait here, layer by layer, and are cut where fresher ones come.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "rate/strategy.hpp"

namespace sweepcast {

/// A frame to queue. What its bytes are is the owner's affair.
struct QueuedFrame {
  std::uint64_t frame = 0;              ///< the owner's number
  std::uint8_t stream = 0;              ///< the sensor: a frame overtakes those of its own alone
  std::vector<std::size_t> layer_ends;  ///< bytes from the frame's start, rising, at least one
  std::int64_t deadline_us = 0;         ///< then it is given up, as far as it is
};

/// What is to be sent next of a frame: its layer at hand, from where that has got to.
struct NextBytes {
  std::uint64_t frame = 0;
  std::size_t layer = 0;
  std::size_t begin = 0;      ///< bytes from the frame's start
  std::size_t layer_end = 0;  ///< the same
  std::size_t end = 0;        ///< of the last layer that is to be sent
};

/// What became of frames.
struct SendCounts {
  std::uint64_t sent = 0;     ///< all layers left
  std::uint64_t cut = 0;      ///< at least one layer left whole, but not all
  std::uint64_t dropped = 0;  ///< none did
};

/// The frames that are not fully sent. `oldest_first` sends all of them whole, in order.
///
/// `freshest_first` sends the newest frame of a stream first, its layers in order, and cuts what it
/// overtakes:
/// - A frame of which whole layers are taken ends with the last of these.
/// - One that is in its first layer, and not older than `kFinishUs`, goes on to that layer's end
///   before the newest begins: else, where a layer takes longer than the time between sweeps, none
///   would ever be through.
/// - Of others the first `late_layers` wait until nothing fresher is left to send, the newest of
///   them first.
///
/// Of several streams the one whose next layer is coarsest goes first, and of equals each in turn.
class SendQueue {
 public:
  static constexpr std::int64_t kFinishUs = 200'000;

  /// `late_layers`: 0 drops what is overtaken, for a receiver that takes a stream's frames in order
  /// alone.
  explicit SendQueue(SendOrder order, std::size_t late_layers = 0)
      : order_(order), late_layers_(late_layers) {}

  /// Times never fall.
  void push(QueuedFrame frame, std::int64_t now_us);

  /// What goes next; none where nothing is left to send.
  [[nodiscard]] std::optional<NextBytes> next(std::int64_t now_us);
  /// Counts so many bytes, at least one and not beyond the end, of what `next` told as sent.
  void take(std::size_t bytes);

  /// Gives up all that waits, as where the connection is lost.
  void clear();

  [[nodiscard]] std::size_t frames() const;
  [[nodiscard]] bool contains(std::uint64_t frame) const;
  /// Not yet taken.
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] const SendCounts& counts() const { return counts_; }

 private:
  struct Waiting {
    QueuedFrame what;
    std::int64_t since_us = 0;
    std::size_t taken = 0;
    bool is_cut = false;  ///< layers at its end were given up

    [[nodiscard]] std::size_t left() const { return what.layer_ends.back() - taken; }
    [[nodiscard]] std::size_t layer() const;
  };
  using Stream = std::deque<Waiting>;  ///< in the order in which they go

  static bool finishes_layer(const Waiting& waiting, std::int64_t now_us);
  void overtake(Stream& stream, bool finishes_first);
  void give_up(std::int64_t now_us);
  void count(const Waiting& over);

  SendOrder order_;
  std::size_t late_layers_;
  std::map<std::uint8_t, Stream> streams_;
  std::uint8_t turn_ = 0;  ///< the stream that `next` told of
  SendCounts counts_;
};

}  // namespace sweepcast
