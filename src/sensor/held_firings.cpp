#include "sensor/held_firings.hpp"

#include <algorithm>
#include <cstddef>

namespace sweepcast {
namespace {

// A beam's lag, how much of it is interpolated, and how many points that says to be held.
struct Split {
  std::int32_t lag = 0;
  std::int32_t interpolated = 0;
  std::size_t held = 0;
};

// What a beam's points say of the part of its lag that is interpolated: by how many ticks those
// that fit no firing miss one in which the beam has no point. `firing`: per tick, whether it is
// one. 0 where they miss by this and that.
Split split(std::span<const std::int32_t> ticks, std::int32_t lag,
            std::span<const std::uint8_t> firing, int turn) {
  constexpr std::int32_t kReach = 64;
  constexpr std::size_t kFewest = 50;  // points that tell something
  std::vector<std::uint8_t> own(firing.size(), 0);
  std::vector<std::int32_t> strays;
  for (const std::int32_t tick : ticks) {
    const std::size_t at = wrapped_tick(tick - lag, turn);
    own[at] = 1;
    if (firing[at] == 0) strays.push_back(static_cast<std::int32_t>(at));
  }
  std::vector<std::size_t> score(2 * kReach + 1, 0);
  for (const std::int32_t tick : strays) {
    for (std::int32_t miss = -kReach; miss <= kReach; ++miss) {
      const std::size_t at = wrapped_tick(tick + miss, turn);
      if (firing[at] != 0 && own[at] == 0) ++score[static_cast<std::size_t>(miss + kReach)];
    }
  }
  const auto most = std::max_element(score.begin(), score.end());
  if (*most < kFewest || 2 * *most < strays.size()) return {lag, 0, 0};
  return {lag, static_cast<std::int32_t>(most - score.begin()) - kReach, *most};
}

// Ticks that are firings: those that have more points than a third of what a point's tick has on
// average.
std::vector<std::uint8_t> firings_of(std::span<const std::vector<std::int32_t>> ticks,
                                     std::span<const std::int32_t> lags, int turn) {
  std::vector<std::uint32_t> count(static_cast<std::size_t>(turn), 0);
  std::uint64_t points = 1;
  for (std::size_t k = 0; k < ticks.size(); ++k) {
    for (const std::int32_t tick : ticks[k]) ++count[wrapped_tick(tick - lags[k], turn)];
    points += ticks[k].size();
  }
  std::uint64_t squares = 0;
  for (const std::uint32_t n : count) squares += std::uint64_t{n} * n;
  std::vector<std::uint8_t> firing(count.size());
  std::transform(count.begin(), count.end(), firing.begin(), [&](std::uint32_t n) {
    return static_cast<std::uint8_t>(3 * points * n > squares ? 1 : 0);
  });
  return firing;
}

}  // namespace

std::int32_t usual_step(std::span<const std::uint8_t> firing) {
  std::vector<std::size_t> steps(firing.size(), 0);
  std::size_t last = firing.size();
  for (std::size_t t = 0; t < firing.size(); ++t) {
    if (firing[t] == 0) continue;
    if (last < t) ++steps[t - last];
    last = t;
  }
  return static_cast<std::int32_t>(std::max_element(steps.begin(), steps.end()) - steps.begin());
}

std::vector<std::int32_t> fit_interpolation(std::span<const std::vector<std::int32_t>> ticks,
                                            std::span<std::int32_t> lags, int ticks_per_turn) {
  const std::vector<std::uint8_t> firing = firings_of(ticks, lags, ticks_per_turn);
  const std::int32_t step = usual_step(firing);
  std::vector<std::int32_t> interpolated(ticks.size(), 0);
  for (std::size_t k = 0; k < ticks.size(); ++k) {
    Split best = split(ticks[k], lags[k], firing, ticks_per_turn);
    if (best.interpolated == 0) continue;
    // Where firings are at nearly equal distances, lags are known but for whole steps. Points of
    // held firings tell, since they do not depend on how far the next firing is.
    for (const std::int32_t lag : {lags[k] - step, lags[k] + step}) {
      const Split other = split(ticks[k], lag, firing, ticks_per_turn);
      if (other.held > best.held) best = other;
    }
    lags[k] = best.lag;
    interpolated[k] = best.interpolated;
  }
  return interpolated;
}

std::span<const std::uint8_t> HeldFirings::find(std::span<FiringPlace> places,
                                                std::span<const std::int32_t> interpolated,
                                                int ticks_per_turn) {
  const auto turn = static_cast<std::size_t>(ticks_per_turn);
  held_.assign(turn, 0);
  as_turning_.assign(turn, 0);
  as_held_.assign(turn, 0);
  near_.assign(turn, 0);
  number_.assign(turn, 0);
  votes_.assign(turn, 0);
  const auto turning = [](const FiringPlace& place) {
    return static_cast<std::size_t>(place.tick);
  };
  const auto holding = [&](const FiringPlace& place) {
    return wrapped_tick(place.tick + interpolated[place.beam], ticks_per_turn);
  };
  for (const FiringPlace& place : places) {
    if (place.tick < 0) continue;
    ++as_turning_[turning(place)];
    for (int off = -kInterpolationJitter; off <= kInterpolationJitter; ++off) {
      ++near_[wrapped_tick(place.tick + off, ticks_per_turn)];
    }
    ++as_held_[holding(place)];
  }
  // Interpolated azimuths jitter, held ones do not.
  for (const FiringPlace& place : places) {
    if (place.tick < 0 || interpolated[place.beam] == 0) continue;
    if (as_held_[holding(place)] > near_[turning(place)]) {
      ++votes_[holding(place)];
    } else {
      --votes_[turning(place)];
    }
  }
  std::size_t count = 0;  // of held firings
  for (std::size_t t = 0; t < turn; ++t) {
    held_[t] = votes_[t] > 0 ? 1 : 0;
    number_[t] = static_cast<std::int32_t>(count);
    count += held_[t];
  }
  has_point_.assign(count * interpolated.size(), 0);
  for (FiringPlace& place : places) {
    if (place.tick < 0 || interpolated[place.beam] == 0) continue;
    const bool may_turn = held_[turning(place)] == 0;
    std::uint8_t* const has_point =
        held_[holding(place)] == 0
            ? nullptr
            : &has_point_[static_cast<std::size_t>(number_[holding(place)]) * interpolated.size() +
                          place.beam];
    // A beam's second point may be another firing's that lies there too.
    const bool may_be_other =
        may_turn && 4 * as_turning_[turning(place)] > as_held_[holding(place)];
    const bool may_hold = has_point != nullptr && (*has_point == 0 || !may_be_other);
    const bool fits_held = as_held_[holding(place)] > as_turning_[turning(place)];
    if (may_hold && (fits_held || !may_turn)) {
      place.tick = static_cast<std::int32_t>(holding(place));
      *has_point = 1;
    } else if (!may_turn) {
      place.tick = -1;
    }
  }
  return held_;
}

}  // namespace sweepcast
