// What `receive` does with sweeps: a thread of its own writes them, so that a slow disk does not
// hold up the network.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "sweepcast/link.hpp"
#include "sweepcast/live/sweep_store.hpp"

namespace sweepcast::app {

class Arrivals {
 public:
  /// So many bytes may wait to be written; a sweep that finds no room is lost.
  static constexpr std::size_t kMostWaiting = std::size_t{64} << 20;

  explicit Arrivals(SweepStore store);
  Arrivals(const Arrivals&) = delete;
  Arrivals& operator=(const Arrivals&) = delete;
  /// Closes, if that was not done.
  ~Arrivals();

  /// Takes a sweep; never waits for the disk. The first sweep of several that cannot be written is
  /// told on standard error.
  void take(const ReceivedSweep& sweep);

  /// Writes what waits, and the indices; to be called when nothing more comes.
  /// Errors: those of `SweepStore::close`; io (some sweeps could not be written, or writing did not
  /// come to an end within 10 s).
  [[nodiscard]] Status close();

  struct Figures {
    std::uint64_t written = 0, lost = 0;  ///< sweeps
    std::uint64_t bytes = 0;              ///< of frames that came
    std::size_t waiting_bytes = 0;
    std::string last;  ///< robot/sensor
  };
  [[nodiscard]] Figures figures() const;

 private:
  struct State;
  std::shared_ptr<State> state_;  ///< the thread's too, which may be stuck in a write for ever
};

}  // namespace sweepcast::app
