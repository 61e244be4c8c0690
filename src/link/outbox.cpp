#include "link/outbox.hpp"

#include <algorithm>
#include <utility>

namespace sweepcast::link {

void Outbox::push(std::uint8_t stream, std::vector<std::vector<std::byte>> layers,
                  Microseconds deadline, Microseconds now) {
  QueuedFrame frame{++last_, stream, {}, deadline};
  std::size_t end = 0;
  for (const auto& layer : layers) frame.layer_ends.push_back(end += layer.size());
  sweeps_[last_] = {stream, ++last_numbers_[stream], deadline, std::move(layers)};
  queue_.push(std::move(frame), now);
  std::erase_if(sweeps_, [&](const auto& sweep) { return !queue_.contains(sweep.first); });
}

std::optional<Fragment> Outbox::peek(Microseconds now) {
  peeked_bytes_ = 0;
  const auto next = queue_.next(now);
  if (!next) return std::nullopt;
  const Sweep& sweep = sweeps_.at(next->frame);
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
  sweeps_.clear();
}

}  // namespace sweepcast::link
