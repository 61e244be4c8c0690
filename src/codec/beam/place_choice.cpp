#include "codec/beam/place_choice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <queue>
#include <utility>

#include "codec/beam/octree_window.hpp"

namespace sweepcast::beam {
namespace {

/// A place that would do for a point.
struct Offer {
  std::uint64_t code;  ///< of the place, Morton's
  std::uint32_t point;
  bool nearest;
  float distance;  ///< squared
};

/// A place that would do for some points.
struct Candidate {
  CubePosition at;            ///< the place; coordinates wrap round below 0
  std::uint32_t first, end;   ///< its offers
  std::uint32_t open = 0;     ///< for how many points without a place it would do, at most
  std::uint32_t nearest = 0;  ///< for how many points it is the nearest
  std::uint32_t faces = 0;    ///< neighbours that are taken
  bool taken = false;
};

// The sides by which two places are one step apart.
constexpr std::array<std::uint32_t, 6> kFaceSides{4, 10, 12, 13, 15, 21};

class PlaceChooser {
 public:
  PlaceChooser(std::size_t points, std::vector<Offer>& offers) : offers_(offers), placed_(points) {
    std::sort(offers.begin(), offers.end(), [](const Offer& a, const Offer& b) {
      return a.code != b.code ? a.code < b.code : a.point < b.point;
    });
    for (std::uint32_t i = 0; i < offers.size(); ++i) {
      if (i == 0 || offers[i].code != offers[i - 1].code) {
        candidates_.push_back({position_of(lattice_point(offers[i].code)), i, i});
      }
      ++candidates_.back().end;
      if (offers[i].nearest) ++candidates_.back().nearest;
    }
    index_.build(candidates_);
  }

  // Takes places until every point has one: first those that do for many points and adjoin others.
  void cover() {
    std::priority_queue<std::pair<std::uint64_t, std::uint32_t>> queue;
    for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
      candidates_[i].open = candidates_[i].end - candidates_[i].first;
      queue.emplace(worth(i), i);
    }
    for (std::size_t left = placed_.size(); left > 0 && !queue.empty();) {
      const auto [promised, i] = queue.top();
      queue.pop();
      if (candidates_[i].taken) continue;
      count_open(i);
      const std::uint64_t own = worth(i);
      if (own < promised) {
        if (own > 0) queue.emplace(own, i);
        continue;
      }
      take(i);
      left -= candidates_[i].open;
      for (const std::uint32_t side : kFaceSides) {
        const std::uint32_t other = index_.find(candidates_, beside(candidates_[i].at, side));
        if (other == kNoNode || candidates_[other].taken || candidates_[other].open == 0) continue;
        ++candidates_[other].faces;
        queue.emplace(worth(other), other);
      }
    }
  }

  // Shares the points out among the places that are taken, in the order in which these are coded:
  // each gets a round number between those that it must have and those that it may have.
  void share(std::vector<LatticePoint>& places) {
    // Of each point, how many places that would do are still to come.
    std::vector<std::uint32_t> to_come(placed_.size(), 0);
    for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
      if (!candidates_[i].taken) continue;
      for (const Offer& offer : offers_of(i)) ++to_come[offer.point];
    }
    std::fill(placed_.begin(), placed_.end(), std::uint8_t{0});
    std::vector<Offer> open;
    for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
      if (!candidates_[i].taken) continue;
      open.clear();
      for (const Offer& offer : offers_of(i)) {
        --to_come[offer.point];
        if (placed_[offer.point] == 0) open.push_back(offer);
      }
      const auto must = std::partition(
          open.begin(), open.end(), [&](const Offer& offer) { return to_come[offer.point] == 0; });
      // Those that have fewer places to come first, so that later places have more of a choice.
      std::sort(must, open.end(), [&](const Offer& a, const Offer& b) {
        if (to_come[a.point] != to_come[b.point]) return to_come[a.point] < to_come[b.point];
        return a.distance != b.distance ? a.distance < b.distance : a.point < b.point;
      });
      const std::size_t count =
          roundest(static_cast<std::size_t>(must - open.begin()), open.size());
      for (std::size_t k = 0; k < count; ++k) {
        placed_[open[k].point] = 1;
        places[open[k].point] = lattice_point(open[k].code);
      }
    }
  }

 private:
  static CubePosition position_of(const LatticePoint& place) {
    return {static_cast<std::uint32_t>(place[0]), static_cast<std::uint32_t>(place[1]),
            static_cast<std::uint32_t>(place[2])};
  }

  // The number of the range with the most zeros at its end; the largest of these.
  static std::size_t roundest(std::size_t from, std::size_t to) {
    std::size_t best = to;
    for (std::size_t unit = 2; unit <= to && to / unit * unit >= std::max<std::size_t>(from, 1);
         unit *= 2) {
      best = to / unit * unit;
    }
    return best;
  }

  [[nodiscard]] std::span<const Offer> offers_of(std::uint32_t i) const {
    return std::span<const Offer>(offers_).subspan(candidates_[i].first,
                                                   candidates_[i].end - candidates_[i].first);
  }

  // What speaks for a place: points that have none yet, neighbours taken, points that are near.
  // Measured on seven sensors' sweeps.
  [[nodiscard]] std::uint64_t worth(std::uint32_t i) const {
    const Candidate& candidate = candidates_[i];
    return candidate.open * (std::uint64_t{5} + 20 * std::uint64_t{candidate.faces} +
                             2 * std::uint64_t{candidate.nearest});
  }

  void count_open(std::uint32_t i) {
    candidates_[i].open = 0;
    for (const Offer& offer : offers_of(i)) candidates_[i].open += 1U - placed_[offer.point];
  }

  void take(std::uint32_t i) {
    candidates_[i].taken = true;
    for (const Offer& offer : offers_of(i)) placed_[offer.point] = 1;
  }

  std::span<const Offer> offers_;
  std::vector<std::uint8_t> placed_;  ///< whether each point has a place
  std::vector<Candidate> candidates_;
  NodeIndex index_;
};

// All places that would do for a point: the nearest, and those one step away on each axis that lie
// within the bound. The step is more than the bound, so that there are no others.
void list_offers(std::array<float, 3> xyz, std::uint32_t point, double step, double max_error_m,
                 std::vector<Offer>& offers) {
  LatticePoint nearest{};
  if (!nearest_place({xyz[0], xyz[1], xyz[2]}, step, nearest)) return;
  std::array<std::array<double, 3>, 3> off{};  // squared; on each axis, at each of three places
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::int32_t i = 0; i < 3; ++i) {
      const std::int32_t at = nearest[axis] + i - 1;
      const double d = double{static_cast<float>(at * step)} - double{xyz[axis]};
      const bool inside = std::abs(at) < kLatticeLimit;
      off[axis][static_cast<std::size_t>(i)] = inside ? d * d : HUGE_VAL;
    }
  }
  for (std::size_t i = 0; i < 27; ++i) {
    const std::array<std::size_t, 3> way{i / 9, i / 3 % 3, i % 3};
    const double squared = off[0][way[0]] + off[1][way[1]] + off[2][way[2]];
    const bool is_nearest = i == 13;
    if (!is_nearest && squared > max_error_m * max_error_m) continue;
    LatticePoint place = nearest;
    for (std::size_t axis = 0; axis < 3; ++axis)
      place[axis] += static_cast<std::int32_t>(way[axis]) - 1;
    offers.push_back({lattice_code(place), point, is_nearest, static_cast<float>(squared)});
  }
}

}  // namespace

bool nearest_place(std::array<double, 3> xyz, double step, LatticePoint& place) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double steps = std::floor(xyz[axis] / step + 0.5);
    if (!(std::abs(steps) < kLatticeLimit)) return false;  // so also where it is NaN
    place[axis] = static_cast<std::int32_t>(steps);
  }
  return true;
}

void choose_places(std::span<const float> x, std::span<const float> y, std::span<const float> z,
                   double step, double max_error_m, std::vector<LatticePoint>& places) {
  std::vector<Offer> offers;
  for (std::uint32_t i = 0; i < x.size(); ++i) {
    list_offers({x[i], y[i], z[i]}, i, step, max_error_m, offers);
  }
  places.resize(x.size());
  PlaceChooser chooser(x.size(), offers);
  chooser.cover();
  chooser.share(places);
}

}  // namespace sweepcast::beam
