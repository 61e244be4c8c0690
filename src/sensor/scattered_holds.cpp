// Held firings of drivers that interpolate the azimuths of nearly all beams.
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
#include <optional>

#include "sensor/held_firings.hpp"

namespace sweepcast {
namespace {

constexpr std::int32_t kShift = 64;  // ticks; more of a lag is not interpolated

// Beams' ticks, less their lags.
using BeamTicks = std::vector<std::vector<std::int32_t>>;

BeamTicks less_lags(std::span<const std::vector<std::int32_t>> ticks,
                    std::span<const std::int32_t> lags, int turn) {
  BeamTicks firings(ticks.size());
  for (std::size_t k = 0; k < ticks.size(); ++k) {
    for (const std::int32_t tick : ticks[k]) {
      firings[k].push_back(static_cast<std::int32_t>(wrapped_tick(tick - lags[k], turn)));
    }
  }
  return firings;
}

// Per tick, how many points it and the ticks beside it have.
std::vector<std::uint32_t> support_of(const BeamTicks& ticks, int turn) {
  std::vector<std::uint32_t> support(static_cast<std::size_t>(turn), 0);
  for (const auto& own : ticks) {
    for (const std::int32_t tick : own) {
      for (int off = -kInterpolationJitter; off <= kInterpolationJitter; ++off) {
        ++support[wrapped_tick(tick + off, turn)];
      }
    }
  }
  return support;
}

// Per tick, whether firings are there: it has more points about it than a third of what a point has
// on average.
std::vector<std::uint8_t> supported(const BeamTicks& ticks,
                                    std::span<const std::uint32_t> support) {
  std::uint64_t sum = 0;
  std::uint64_t points = 0;
  for (const auto& own : ticks) {
    for (const std::int32_t tick : own) sum += support[static_cast<std::size_t>(tick)];
    points += own.size();
  }
  std::vector<std::uint8_t> firing(support.size());
  std::transform(support.begin(), support.end(), firing.begin(), [&](std::uint32_t n) {
    return static_cast<std::uint8_t>(3 * points * n > sum ? 1 : 0);
  });
  return firing;
}

// Of ticks that firings jitter over, those in the middle.
std::vector<std::uint8_t> middles(std::span<const std::uint8_t> firing,
                                  std::span<const std::uint32_t> support) {
  const auto turn = static_cast<int>(support.size());
  std::vector<std::uint8_t> middle(firing.begin(), firing.end());
  for (int t = 0; t < turn; ++t) {
    const auto at = static_cast<std::size_t>(t);
    for (int off = 1; off <= 3 * kInterpolationJitter; ++off) {
      const bool highest = support[at] >= support[wrapped_tick(t + off, turn)] &&
                           support[at] > support[wrapped_tick(t - off, turn)];
      if (!highest) middle[at] = 0;
    }
  }
  return middle;
}

BeamTicks strays_of(const BeamTicks& ticks, std::span<const std::uint8_t> firing) {
  BeamTicks strays(ticks.size());
  for (std::size_t k = 0; k < ticks.size(); ++k) {
    std::copy_if(ticks[k].begin(), ticks[k].end(), std::back_inserter(strays[k]),
                 [&](std::int32_t tick) { return firing[static_cast<std::size_t>(tick)] == 0; });
  }
  return strays;
}

// The shift at which a beam's ticks best fall on those of others. The more of these agree the surer
// they are.
std::int32_t best_shift(std::span<const std::int32_t> own, std::span<const std::int32_t> beams,
                        int turn) {
  std::vector<std::int64_t> score(2 * kShift + 1, 0);
  for (const std::int32_t tick : own) {
    for (std::int32_t off = -kShift; off <= kShift; ++off) {
      const std::int32_t there = beams[wrapped_tick(tick + off, turn)];
      score[static_cast<std::size_t>(off + kShift)] += std::int64_t{there} * there;
    }
  }
  return static_cast<std::int32_t>(std::max_element(score.begin(), score.end()) - score.begin()) -
         kShift;
}

// Shifts each beam's ticks by up to `kShift` such that they fall on the others'. Gives per tick how
// many beams' do then.
std::vector<std::int32_t> gather(const BeamTicks& ticks, int turn) {
  std::vector<std::int32_t> shift(ticks.size(), 0);
  std::vector<std::int32_t> beams(static_cast<std::size_t>(turn), 0);
  std::vector<std::size_t> order(ticks.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return ticks[a].size() > ticks[b].size(); });
  const auto count = [&](std::size_t k, std::int32_t weight) {
    for (const std::int32_t tick : ticks[k]) {
      beams[wrapped_tick(tick + shift[k], turn)] += weight;
    }
  };
  for (int round = 0; round < 3; ++round) {
    for (const std::size_t k : order) {
      if (round > 0) count(k, -1);
      if (round > 0 || k != order.front()) shift[k] = best_shift(ticks[k], beams, turn);
      count(k, 1);
    }
  }
  return beams;
}

// Ticks at which many beams meet.
std::vector<std::int32_t> meetings(std::span<const std::int32_t> beams) {
  std::int64_t squares = 0;
  std::int64_t sum = 0;
  for (const std::int64_t n : beams) {
    squares += n * n;
    sum += n;
  }
  std::vector<std::int32_t> ticks;
  for (std::size_t t = 0; t < beams.size(); ++t) {
    const std::int64_t n = beams[t];
    if (n > 2 && 3 * sum * n > squares) ticks.push_back(static_cast<std::int32_t>(t));
  }
  return ticks;
}

// Moves all held firings by as much as puts most of them a whole step after the firing before.
void centre_between(std::span<const std::uint8_t> middle, std::int32_t step,
                    std::vector<std::int32_t>& held) {
  if (step < 2) return;
  const auto turn = static_cast<int>(middle.size());
  std::vector<std::size_t> after(static_cast<std::size_t>(step), 0);
  for (const std::int32_t tick : held) {
    for (std::int32_t back = 0; back < 2 * step; ++back) {
      if (middle[wrapped_tick(tick - back, turn)] == 0) continue;
      ++after[static_cast<std::size_t>(back % step)];
    }
  }
  // Firings jitter: three neighbouring distances count.
  const auto near = [&](std::int32_t at) {
    return after[static_cast<std::size_t>((at + step - 1) % step)] +
           2 * after[static_cast<std::size_t>(at)] +
           after[static_cast<std::size_t>((at + 1) % step)];
  };
  std::int32_t best = 0;
  for (std::int32_t at = 1; at < step; ++at) best = near(at) > near(best) ? at : best;
  if (2 * best > step) best -= step;
  for (std::int32_t& tick : held) tick = static_cast<std::int32_t>(wrapped_tick(tick - best, turn));
}

// One beam against the held firings.
class BeamInHeld {
 public:
  BeamInHeld(std::span<const std::int32_t> ticks, std::span<const std::int32_t> held, int turn)
      : held_(held), turn_(turn), points_(static_cast<std::size_t>(turn), 0) {
    for (const std::int32_t tick : ticks) ++points_[static_cast<std::size_t>(tick)];
  }

  // By how many ticks the beam's points come before most held firings; nothing where they do before
  // fewer than half. Points tell whose ticks happen to look like another firing's, too.
  [[nodiscard]] std::optional<std::int32_t> distance() const {
    std::size_t most = 0;
    std::int32_t best = 0;
    for (std::int32_t off = -kShift; off <= kShift; ++off) {
      const auto here = static_cast<std::size_t>(
          std::count_if(held_.begin(), held_.end(),
                        [&](std::int32_t tick) { return points_at(tick - off) > 0; }));
      best = here > most ? off : best;
      most = std::max(most, here);
    }
    if (most == 0 || 2 * most < held_.size()) return std::nullopt;
    return best;
  }

  // In how many held firings, moved by `shift`, the beam has points besides that `distance` before.
  [[nodiscard]] std::size_t others(std::int32_t shift, std::int32_t reach,
                                   std::int32_t distance) const {
    return static_cast<std::size_t>(
        std::count_if(held_.begin(), held_.end(), [&](std::int32_t tick) {
          std::int32_t points = 0;
          for (std::int32_t at = shift - reach; at <= shift + reach; ++at) {
            points += points_at(tick + at) - (at == -distance ? 1 : 0);
          }
          return points > 0;
        }));
  }

 private:
  [[nodiscard]] std::int32_t points_at(std::int32_t tick) const {
    return points_[wrapped_tick(tick, turn_)];
  }

  std::span<const std::int32_t> held_;
  int turn_;
  std::vector<std::int32_t> points_;  // per tick
};

}  // namespace

std::vector<std::int32_t> fit_scattered_holds(std::span<const std::vector<std::int32_t>> ticks,
                                              std::span<std::int32_t> lags, int ticks_per_turn) {
  const BeamTicks turning = less_lags(ticks, lags, ticks_per_turn);
  const auto support = support_of(turning, ticks_per_turn);
  const auto firing = supported(turning, support);
  const auto middle = middles(firing, support);
  const std::int32_t step = usual_step(middle);
  auto held = meetings(gather(strays_of(turning, firing), ticks_per_turn));
  centre_between(middle, step, held);
  std::vector<std::int32_t> interpolated(ticks.size(), 0);
  std::vector<std::size_t> unknown;
  std::map<std::int32_t, std::size_t> beams_by_rest;  // by what of their lags is not interpolated
  for (std::size_t k = 0; k < ticks.size(); ++k) {
    const BeamInHeld beam(turning[k], held, ticks_per_turn);
    const std::optional<std::int32_t> distance = beam.distance();
    if (!distance) {
      unknown.push_back(k);
      continue;
    }
    // Where firings are at nearly equal distances, lags are known but for whole steps. With the
    // right one no turning firing's points come where a held firing is.
    std::int32_t best = 0;
    for (const std::int32_t shift : {-step, step}) {
      if (2 * beam.others(shift, step / 4, *distance) < beam.others(best, step / 4, *distance)) {
        best = shift;
      }
    }
    lags[k] += best;
    interpolated[k] = *distance + best;
    ++beams_by_rest[lags[k] - interpolated[k]];
  }
  // Where all of each beam's lag is interpolated, as where beams look the same way, that of beams
  // with few points follows.
  const auto rest =
      std::max_element(beams_by_rest.begin(), beams_by_rest.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  if (rest != beams_by_rest.end() && 4 * rest->second > 3 * (ticks.size() - unknown.size())) {
    for (const std::size_t k : unknown) interpolated[k] = lags[k] - rest->first;
  }
  return interpolated;
}

}  // namespace sweepcast
