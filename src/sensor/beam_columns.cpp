#include "sensor/beam_columns.hpp"

#include <algorithm>

namespace sweepcast {

std::span<const std::int32_t> ColumnFinder::find(std::span<const FiringPlace> places,
                                                 std::span<const std::uint8_t> held,
                                                 int ticks_per_turn, int beams, int jitter,
                                                 std::vector<std::int32_t>& firing_tick) {
  column_.assign(static_cast<std::size_t>(ticks_per_turn), -1);
  count_.assign(static_cast<std::size_t>(ticks_per_turn), 0);
  for (const FiringPlace& place : places) {
    if (place.tick >= 0) ++count_[static_cast<std::size_t>(place.tick)];
  }
  firing_tick.clear();
  if (jitter == 0) {
    one_each(firing_tick);
  } else {
    gather(places, held, beams, jitter, firing_tick);
  }
  return column_;
}

void ColumnFinder::one_each(std::vector<std::int32_t>& firing_tick) {
  for (std::size_t t = 0; t < count_.size(); ++t) {
    if (count_[t] == 0) continue;
    column_[t] = static_cast<std::int32_t>(firing_tick.size());
    firing_tick.push_back(static_cast<std::int32_t>(t));
  }
}

void ColumnFinder::gather(std::span<const FiringPlace> places, std::span<const std::uint8_t> held,
                          int beams, int jitter, std::vector<std::int32_t>& firing_tick) {
  const std::size_t words = (static_cast<std::size_t>(beams) + 63) / 64;
  slot_.assign(count_.size(), 0);
  std::int32_t slots = 0;
  for (std::size_t t = 0; t < count_.size(); ++t) {
    if (count_[t] > 0) slot_[t] = slots++;
  }
  // One more set than ticks: that of the column being gathered.
  sets_.assign((static_cast<std::size_t>(slots) + 1) * words, 0);
  const auto set_of = [&](std::int32_t slot) {
    return std::span(sets_).subspan(static_cast<std::size_t>(slot) * words, words);
  };
  for (const FiringPlace& place : places) {
    if (place.tick < 0) continue;
    const auto set = set_of(slot_[static_cast<std::size_t>(place.tick)]);
    set[place.beam / 64] |= std::uint64_t{1} << (place.beam % 64);
  }
  const auto column = set_of(slots);
  std::int32_t first = -1;
  std::int32_t most = 0;
  for (std::size_t t = 0; t < count_.size(); ++t) {
    if (count_[t] == 0) continue;
    const auto tick = static_cast<std::int32_t>(t);
    const auto set = set_of(slot_[t]);
    bool joins = first >= 0 && tick - first <= jitter;
    if (!held.empty()) joins = joins && held[t] == held[static_cast<std::size_t>(first)];
    for (std::size_t w = 0; w < words; ++w) joins = joins && (set[w] & column[w]) == 0;
    if (!joins) {
      std::fill(column.begin(), column.end(), 0);
      first = tick;
      most = 0;
      firing_tick.push_back(tick);
    }
    for (std::size_t w = 0; w < words; ++w) column[w] |= set[w];
    if (count_[t] > most) {
      most = count_[t];
      firing_tick.back() = tick;
    }
    column_[t] = static_cast<std::int32_t>(firing_tick.size()) - 1;
  }
}

}  // namespace sweepcast
