#include "rate/send_queue.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace sweepcast {

/// The layer that the next byte belongs to.
std::size_t SendQueue::Waiting::layer() const {
  const auto& ends = what.layer_ends;
  return static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), taken) - ends.begin());
}

void SendQueue::push(QueuedFrame frame, std::int64_t now_us) {
  give_up(now_us);
  Stream& stream = streams_[frame.stream];
  Waiting waiting{std::move(frame), now_us};
  if (order_ == SendOrder::oldest_first) {
    stream.push_back(std::move(waiting));
    return;
  }
  const bool finishes_first = !stream.empty() && finishes_layer(stream.front(), now_us);
  overtake(stream, finishes_first);
  stream.insert(stream.begin() + (finishes_first ? 1 : 0), std::move(waiting));
}

std::optional<NextBytes> SendQueue::next(std::int64_t now_us) {
  give_up(now_us);
  // From the stream after the one that had its turn, and around.
  const Stream* best = nullptr;
  std::size_t best_layer = std::numeric_limits<std::size_t>::max();
  std::uint8_t best_number = 0;
  auto at = streams_.upper_bound(turn_);
  for (std::size_t i = 0; i < streams_.size(); ++i, ++at) {
    if (at == streams_.end()) at = streams_.begin();
    if (at->second.empty() || at->second.front().layer() >= best_layer) continue;
    best = &at->second;
    best_layer = best->front().layer();
    best_number = at->first;
  }
  if (best == nullptr) return std::nullopt;
  turn_ = best_number;
  const Waiting& first = best->front();
  const auto& ends = first.what.layer_ends;
  return NextBytes{first.what.frame, best_layer, first.taken, ends[best_layer], ends.back()};
}

void SendQueue::take(std::size_t bytes) {
  Stream& stream = streams_[turn_];
  if (stream.empty()) return;
  Waiting& first = stream.front();
  first.taken += std::min(bytes, first.left());
  if (first.left() > 0) return;
  count(first);
  stream.pop_front();
}

void SendQueue::clear() {
  give_up(std::numeric_limits<std::int64_t>::max());
}

std::size_t SendQueue::frames() const {
  std::size_t sum = 0;
  for (const auto& [number, stream] : streams_) sum += stream.size();
  return sum;
}

std::size_t SendQueue::bytes() const {
  std::size_t sum = 0;
  for (const auto& [number, stream] : streams_) {
    for (const Waiting& waiting : stream) sum += waiting.left();
  }
  return sum;
}

bool SendQueue::contains(std::uint64_t frame) const {
  return std::any_of(streams_.begin(), streams_.end(), [frame](const auto& stream) {
    return std::any_of(stream.second.begin(), stream.second.end(),
                       [frame](const Waiting& waiting) { return waiting.what.frame == frame; });
  });
}

bool SendQueue::finishes_layer(const Waiting& waiting, std::int64_t now_us) {
  return waiting.taken > 0 && waiting.taken < waiting.what.layer_ends.front() &&
         now_us - waiting.since_us <= kFinishUs;
}

void SendQueue::overtake(Stream& stream, bool finishes_first) {
  const auto keep = [](Waiting& waiting, std::size_t layers) {
    auto& ends = waiting.what.layer_ends;
    if (layers >= ends.size()) return;
    ends.erase(ends.begin() + static_cast<std::ptrdiff_t>(layers), ends.end());
    waiting.is_cut = true;
  };
  if (finishes_first) keep(stream.front(), 1);
  bool is_first = true;
  std::erase_if(stream, [&](Waiting& waiting) {
    const bool finishes = std::exchange(is_first, false) && finishes_first;
    if (!finishes && (late_layers_ == 0 || waiting.taken >= waiting.what.layer_ends.front())) {
      count(waiting);
      return true;
    }
    keep(waiting, std::max<std::size_t>(late_layers_, 1));
    return false;
  });
}

void SendQueue::give_up(std::int64_t now_us) {
  for (auto& [number, stream] : streams_) {
    std::erase_if(stream, [&](const Waiting& waiting) {
      if (now_us < waiting.what.deadline_us) return false;
      count(waiting);
      return true;
    });
  }
}

void SendQueue::count(const Waiting& over) {
  if (over.left() == 0 && !over.is_cut) {
    ++counts_.sent;
  } else if (over.taken >= over.what.layer_ends.front()) {
    ++counts_.cut;
  } else {
    ++counts_.dropped;
  }
}

}  // namespace sweepcast
