#include "link/outbox.hpp"

#include <algorithm>
#include <utility>

namespace sweepcast::link {

void Outbox::push(std::uint8_t stream, std::vector<std::vector<std::byte>> layers,
                  Microseconds deadline, Microseconds now, std::optional<std::size_t> level) {
  QueuedFrame frame{++last_, stream, {}, deadline};
  std::size_t end = 0;
  for (const auto& layer : layers) frame.layer_ends.push_back(end += layer.size());
  queue_.push(std::move(frame), now);
  settle();
  const auto queued = std::count_if(sweeps_.begin(), sweeps_.end(), [stream](const auto& sweep) {
    return sweep.second.stream == stream;
  });
  sweeps_[last_] = {stream, ++last_numbers_[stream],          deadline, std::move(layers),
                    level,  static_cast<std::size_t>(queued), end};
}

/// Lets go of the sweeps that are over, of which now is known what became of them.
void Outbox::settle() {
  std::erase_if(sweeps_, [&](const auto& entry) {
    const auto& [number, sweep] = entry;
    if (queue_.contains(number)) return false;
    qoe_[sweep.stream].add(sweep.level, sweep.queued, sweep.left == 0);
    return true;
  });
}

void Outbox::pop() {
  if (peeked_bytes_ == 0) return;
  queue_.take(peeked_bytes_);
  sweeps_.at(peeked_).left -= peeked_bytes_;
}

std::optional<double> Outbox::qoe() {
  settle();
  double sum = 0.0;
  int streams = 0;
  for (const QoeMeter& meter : qoe_) {
    if (const auto mean = meter.mean()) {
      sum += *mean;
      ++streams;
    }
  }
  if (streams == 0) return std::nullopt;
  return sum / streams;
}

std::optional<Fragment> Outbox::peek(Microseconds now) {
  peeked_bytes_ = 0;
  const auto next = queue_.next(now);
  if (!next) return std::nullopt;
  peeked_ = next->frame;
  const Sweep& sweep = sweeps_.at(peeked_);
  const std::vector<std::byte>& layer = sweep.layers[next->layer];
  const std::size_t offset = next->begin + layer.size() - next->layer_end;
  Fragment fragment;
  fragment.stream = sweep.stream;
  fragment.layer = static_cast<std::uint8_t>(next->layer);
  fragment.layers = static_cast<std::uint8_t>(sweep.layers.size());
  fragment.sweep = sweep.number;
  fragment.index = static_cast<std::uint16_t>(offset / kFragmentPayload);
  fragment.layer_bytes = static_cast<std::uint32_t>(layer.size());
  fragment.sent_us = static_cast<std::uint32_t>(now);
  fragment.remaining_ms = static_cast<std::uint16_t>(
      std::clamp<Microseconds>((sweep.deadline - now + 999) / 1000, 0, 0xFFFF));
  peeked_bytes_ = std::min(kFragmentPayload, layer.size() - offset);
  fragment.payload = std::span(layer).subspan(offset, peeked_bytes_);
  return fragment;
}

void Outbox::clear() {
  queue_.clear();
  peeked_bytes_ = 0;
  settle();
}

}  // namespace sweepcast::link
