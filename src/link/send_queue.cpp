#include "link/send_queue.hpp"

#include <algorithm>
#include <utility>

namespace sweepcast::link {

void SendQueue::push(std::uint8_t stream, std::vector<std::vector<std::byte>> layers,
                     Microseconds deadline) {
  Stream& s = streams_[stream];
  Sweep sweep;
  sweep.number = ++s.last_number;
  sweep.end = layers.size();
  sweep.layers = std::move(layers);
  sweep.deadline = deadline;
  if (s.next) ++counts_.dropped;
  s.next = std::move(sweep);
  if (!s.sweep) {
    s.sweep = std::exchange(s.next, std::nullopt);
  } else if (s.sweep->fragment == 0) {
    finish(s);  // before its first layer, or between two
  } else {
    s.sweep->end = s.sweep->layer + 1;
  }
}

/// Ends the stream's sweep where it is, and goes on with the next one.
void SendQueue::finish(Stream& stream) {
  const Sweep& sweep = *stream.sweep;
  if (sweep.layer == sweep.layers.size()) {
    ++counts_.sent;
  } else if (sweep.layer > 0) {
    ++counts_.cut;
  } else {
    ++counts_.dropped;
  }
  stream.sweep = std::exchange(stream.next, std::nullopt);
}

std::optional<Fragment> SendQueue::peek(Microseconds now) {
  // The coarsest layer that waits goes first; of equals the stream whose turn comes next.
  const Stream* best = nullptr;
  std::uint8_t best_number = 0;
  for (std::uint8_t i = 0; i < kMostStreams; ++i) {
    const auto number = static_cast<std::uint8_t>((turn_ + 1 + i) % kMostStreams);
    Stream& stream = streams_[number];
    while (stream.sweep && stream.sweep->deadline <= now) finish(stream);
    if (!stream.sweep) continue;
    if (best != nullptr && stream.sweep->layer >= best->sweep->layer) continue;
    best = &stream;
    best_number = number;
  }
  if (best == nullptr) return std::nullopt;
  turn_ = best_number;
  const Sweep& sweep = *best->sweep;
  const std::vector<std::byte>& layer = sweep.layers[sweep.layer];
  Fragment fragment;
  fragment.stream = best_number;
  fragment.layer = static_cast<std::uint8_t>(sweep.layer);
  fragment.layers = static_cast<std::uint8_t>(sweep.layers.size());
  fragment.sweep = sweep.number;
  fragment.index = static_cast<std::uint16_t>(sweep.fragment);
  fragment.layer_bytes = static_cast<std::uint32_t>(layer.size());
  fragment.sent_us = static_cast<std::uint32_t>(now);
  fragment.remaining_ms = static_cast<std::uint16_t>(
      std::min<Microseconds>((sweep.deadline - now + 999) / 1000, 0xFFFF));
  const std::size_t size = std::min(kFragmentPayload, layer.size() - fragment.offset());
  fragment.payload = std::span(layer).subspan(fragment.offset(), size);
  return fragment;
}

void SendQueue::pop() {
  Stream& stream = streams_[turn_];
  if (!stream.sweep) return;
  Sweep& sweep = *stream.sweep;
  if (++sweep.fragment < fragment_count(sweep.layers[sweep.layer].size())) return;
  sweep.fragment = 0;
  if (++sweep.layer == sweep.end) finish(stream);
}

void SendQueue::clear() {
  for (Stream& stream : streams_) {
    while (stream.sweep) finish(stream);
  }
}

bool SendQueue::empty() const {
  return std::none_of(streams_.begin(), streams_.end(),
                      [](const Stream& stream) { return stream.sweep.has_value(); });
}

std::size_t SendQueue::queued_bytes() const {
  std::size_t bytes = 0;
  const auto add = [&](const std::optional<Sweep>& sweep) {
    if (!sweep) return;
    for (std::size_t i = sweep->layer; i < sweep->end; ++i) bytes += sweep->layers[i].size();
    bytes -= sweep->fragment * kFragmentPayload;
  };
  for (const Stream& stream : streams_) {
    add(stream.sweep);
    add(stream.next);
  }
  return bytes;
}

}  // namespace sweepcast::link
