#include "rate/send_queue.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace sweepcast {

void SendQueue::push(std::uint64_t frame, std::vector<std::size_t> layer_ends,
                     std::int64_t now_us) {
  Waiting waiting{frame, now_us, 0, std::move(layer_ends)};
  if (order_ == SendOrder::oldest_first) {
    waiting_.push_back(std::move(waiting));
    return;
  }
  give_up(now_us);
  const bool finishes_first = !waiting_.empty() && finishes_layer(waiting_.front(), now_us);
  overtake(finishes_first);
  waiting_.insert(waiting_.begin() + (finishes_first ? 1 : 0), std::move(waiting));
}

std::optional<Piece> SendQueue::next(std::int64_t now_us, std::size_t most_bytes) {
  if (order_ == SendOrder::freshest_first) give_up(now_us);
  if (waiting_.empty()) return std::nullopt;
  Waiting& first = waiting_.front();
  const std::size_t bytes = std::min(most_bytes, first.layer_ends.back() - first.taken);
  const Piece piece{first.frame, first.taken, bytes};
  first.taken += bytes;
  if (first.taken == first.layer_ends.back()) waiting_.pop_front();
  return piece;
}

std::size_t SendQueue::bytes() const {
  return std::accumulate(waiting_.begin(), waiting_.end(), std::size_t{0},
                         [](std::size_t sum, const Waiting& waiting) {
                           return sum + waiting.layer_ends.back() - waiting.taken;
                         });
}

bool SendQueue::contains(std::uint64_t frame) const {
  return std::any_of(waiting_.begin(), waiting_.end(),
                     [frame](const Waiting& waiting) { return waiting.frame == frame; });
}

bool SendQueue::finishes_layer(const Waiting& waiting, std::int64_t now_us) {
  return waiting.taken > 0 && waiting.taken < waiting.layer_ends.front() &&
         now_us - waiting.since_us <= kFinishUs;
}

void SendQueue::overtake(bool finishes_first) {
  if (finishes_first) waiting_.front().layer_ends.resize(1);
  std::erase_if(waiting_, [](Waiting& waiting) {
    auto& ends = waiting.layer_ends;
    if (waiting.taken >= ends.front()) return true;
    ends.resize(std::min(ends.size(), kLateLayers));
    return false;
  });
}

void SendQueue::give_up(std::int64_t now_us) {
  std::erase_if(waiting_,
                [now_us](const Waiting& waiting) { return now_us - waiting.since_us > kLateUs; });
}

}  // namespace sweepcast
