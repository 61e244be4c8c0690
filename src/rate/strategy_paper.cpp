// The RCPCC paper's strategy, section III.C. It tells three schemes and no number; every threshold
// here is ours, named, and explained in docs/rate.md.
#include <algorithm>
#include <array>

#include "rate/recent.hpp"
#include "rate/strategy.hpp"

namespace sweepcast {
namespace {

/// Buffer switching: sweeps between two switches, in which a switch comes to bear on the queue.
constexpr int kSettle = 10;
/// Historical memory: sweeps over which the length of the queue is averaged.
constexpr std::size_t kRememberedQueues = 5;
/// A mean queue above this is too long: one level coarser. Frames.
constexpr double kLongQueue = 3.0;
/// A queue that stays at or below this is stable. Frames.
constexpr std::size_t kStableQueue = 1;
/// Quality improvement attempts: sweeps that the queue must have been stable for.
constexpr int kPatience = 20;
/// An attempt has failed when the queue has grown by more than this. Frames.
constexpr std::size_t kQueueGrowth = 3;
/// An attempt has succeeded when it has gone on for so many sweeps.
constexpr int kTrial = 100;
/// What a failed attempt at a level multiplies the patience before the next one by, and the most.
constexpr int kBackOff = 2;
constexpr int kMostPatience = 80;

class Paper final : public Strategy {
 public:
  Paper() { patience_.fill(kPatience); }

  Choice decide(const LinkView& view) override {
    remember(view.queued_frames);
    if (--settling_ <= 0) {
      if (trying_ && view.queued_frames > queue_before_ + kQueueGrowth) {
        roll_back();
      } else if (history_.mean() > kLongQueue && level_ + 1 < kLevels) {
        switch_to(level_ + 1);
        trying_ = false;
      } else if (level_ > 0 && stable_ >= patience_[level_ - 1]) {
        attempt(view.queued_frames);
      }
    }
    if (trying_ && --trial_ <= 0) succeed();
    return {.level = level_};
  }

 private:
  void remember(std::size_t queue) {
    history_.add(static_cast<double>(queue));
    stable_ = queue <= kStableQueue ? stable_ + 1 : 0;
  }

  void switch_to(std::size_t level) {
    level_ = level;
    settling_ = kSettle;
    stable_ = 0;
  }

  void attempt(std::size_t queue) {
    switch_to(level_ - 1);
    trying_ = true;
    trial_ = kTrial;
    queue_before_ = queue;
  }

  void roll_back() {
    patience_[level_] = std::min(kBackOff * patience_[level_], kMostPatience);
    switch_to(level_ + 1);
    trying_ = false;
  }

  void succeed() {
    patience_[level_] = kPatience;
    trying_ = false;
  }

  std::size_t level_ = 0;
  Recent history_{kRememberedQueues};  ///< queue lengths
  int stable_ = 0;                     ///< sweeps for which the queue has been stable
  int settling_ = 0;                   ///< sweeps until the next switch is allowed
  bool trying_ = false;                ///< an attempt goes on
  int trial_ = 0;                      ///< sweeps until it has succeeded
  std::size_t queue_before_ = 0;
  std::array<int, kLevels> patience_{};  ///< before an attempt at each level
};

}  // namespace

std::unique_ptr<Strategy> make_paper() {
  return std::make_unique<Paper>();
}

}  // namespace sweepcast
