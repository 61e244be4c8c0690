// The firings of a sweep: which ticks make a column of the beam grid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sweepcast {

/// A point's place: its beam and its firing tick (lag taken off), in [0, ticks_per_turn).
struct FiringPlace {
  std::int32_t tick = -1;  ///< -1: no place
  std::uint16_t beam = 0;
};

/// Finds the columns; keeps its buffers.
class ColumnFinder {
 public:
  /// Fills `firing_tick` with the columns' ticks, in order, and returns the column of every tick
  /// (-1 where no point has it). With jitter 0 every tick that occurs is a column. Else ticks at
  /// most `jitter` after the first of a column join it as long as no beam would be there twice;
  /// the column's tick is the one of most points. `held`: per tick, whether the firing was held;
  /// such ones share no column with others; empty: none is.
  std::span<const std::int32_t> find(std::span<const FiringPlace> places,
                                     std::span<const std::uint8_t> held, int ticks_per_turn,
                                     int beams, int jitter, std::vector<std::int32_t>& firing_tick);

 private:
  void one_each(std::vector<std::int32_t>& firing_tick);
  void gather(std::span<const FiringPlace> places, std::span<const std::uint8_t> held, int beams,
              int jitter, std::vector<std::int32_t>& firing_tick);

  std::vector<std::int32_t> column_;  // per tick
  std::vector<std::int32_t> count_;   // per tick: points
  std::vector<std::int32_t> slot_;    // per tick: index of its beam set
  std::vector<std::uint64_t> sets_;   // of beams, per occupied tick
};

}  // namespace sweepcast
