// BOLA: K. Spiteri, R. Urgaonkar, R. Sitaraman, "BOLA: near-optimal bitrate adaptation for online
// videos", INFOCOM 2016. A player's buffer holds what is loaded and not yet shown, and empties
// where the link is slow; a sender's queue fills there. So the buffer is the room that the queue
// has left.
#include <algorithm>
#include <cmath>

#include "rate/strategy.hpp"

namespace sweepcast {
namespace {

/// Frames that the queue may hold: the size of the buffer.
constexpr double kRoom = 10.0;
/// gamma p of the BOLA paper: how much an empty queue is worth beside quality.
constexpr double kGammaP = 5.0;

class Bola final : public Strategy {
 public:
  Choice decide(const LinkView& view) override {
    const double buffer = std::max(0.0, kRoom - static_cast<double>(view.queued_frames));
    const auto smallest = static_cast<double>(view.level_bytes.back());
    const auto utility = [&](std::size_t level) {
      return std::log(static_cast<double>(view.level_bytes[level]) / smallest);
    };
    // The paper's choice of V: with one frame of room less than all, the finest level.
    const double v = (kRoom - 1.0) / (utility(0) + kGammaP);
    const auto score = [&](std::size_t level) {
      return (v * (utility(level) + kGammaP) - buffer) /
             static_cast<double>(view.level_bytes[level]);
    };
    return {.level = best_level(view.level_bytes.size(), score)};
  }
};

}  // namespace

std::unique_ptr<Strategy> make_bola() {
  return std::make_unique<Bola>();
}

}  // namespace sweepcast
