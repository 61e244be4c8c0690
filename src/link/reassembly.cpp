#include "link/reassembly.hpp"

#include <algorithm>

namespace sweepcast::link {
namespace {

/// What holding a layer costs beside its bytes.
constexpr std::size_t kLayerOverhead = 128;

std::size_t cost_of(std::size_t layer_bytes) {
  return layer_bytes + fragment_count(layer_bytes) / 8 + kLayerOverhead;
}

}  // namespace

Reassembler::~Reassembler() {
  shared_.used -= used_;
}

bool Reassembler::reserve(std::size_t bytes) {
  if (bytes > limit_ - used_ || bytes > shared_.limit - shared_.used) return false;
  used_ += bytes;
  shared_.used += bytes;
  return true;
}

FragmentFate Reassembler::add(const Fragment& fragment, Microseconds now,
                              std::vector<ReadySweep>& ready) {
  Stream& stream = streams_[fragment.stream];
  if (fragment.sweep <= stream.last_over) return FragmentFate::late;
  auto found = stream.open.find(fragment.sweep);
  if (found != stream.open.end() && found->second.layers.size() != fragment.layers) {
    return FragmentFate::malformed;
  }
  const bool is_new_layer =
      found == stream.open.end() || found->second.layers[fragment.layer].has.empty();
  if (is_new_layer && !reserve(cost_of(fragment.layer_bytes))) return FragmentFate::over_limit;
  Sweep& sweep = stream.open[fragment.sweep];
  if (sweep.layers.empty()) sweep.layers.resize(fragment.layers);
  Layer& layer = sweep.layers[fragment.layer];
  if (is_new_layer) {
    layer.bytes.resize(fragment.layer_bytes);
    layer.missing = fragment_count(fragment.layer_bytes);
    layer.has.resize(layer.missing);
  }
  if (layer.bytes.size() != fragment.layer_bytes) return FragmentFate::malformed;
  if (layer.has[fragment.index]) return FragmentFate::repeated;
  layer.has[fragment.index] = true;
  --layer.missing;
  std::copy(fragment.payload.begin(), fragment.payload.end(),
            layer.bytes.begin() + static_cast<std::ptrdiff_t>(fragment.offset()));

  // The fragment that took the shortest way tells the deadline best.
  const Microseconds deadline = now + Microseconds{fragment.remaining_ms} * 1000;
  sweep.deadline = sweep.deadline == 0 ? deadline : std::min(sweep.deadline, deadline);
  if (layer.missing == 0) end_what_is_over(fragment.stream, now, ready);
  if (stream.open.size() > kMostOpen) {
    end_until(fragment.stream, stream.open.begin()->first, ready);
  }
  return FragmentFate::taken;
}

void Reassembler::expire(Microseconds now, std::vector<ReadySweep>& ready) {
  for (std::uint8_t number = 0; number < kMostStreams; ++number) {
    end_what_is_over(number, now, ready);
  }
}

bool Reassembler::Sweep::is_whole() const {
  return std::all_of(layers.begin(), layers.end(),
                     [](const Layer& layer) { return layer.is_whole(); });
}

void Reassembler::end_what_is_over(std::uint8_t number, Microseconds now,
                                   std::vector<ReadySweep>& ready) {
  auto& open = streams_[number].open;
  std::uint32_t last = 0;
  std::vector<Sweep*> in_repair;  // older than the one at hand, and not over
  for (auto& [sweep, state] : open) {
    const bool is_whole = state.is_whole();
    if (state.deadline <= now || (is_whole && in_repair.empty())) {
      last = sweep;
      in_repair.clear();
    } else if (is_whole) {
      for (Sweep* older : in_repair) older->deadline = std::min(older->deadline, now + kRepair);
    } else if (!state.layers.front().is_whole()) {
      in_repair.push_back(&state);
    }
  }
  if (last != 0) end_until(number, last, ready);
}

/// Ends a sweep and all older ones of its stream.
void Reassembler::end_until(std::uint8_t number, std::uint32_t sweep,
                            std::vector<ReadySweep>& ready) {
  Stream& stream = streams_[number];
  const auto end = stream.open.upper_bound(sweep);
  for (auto at = stream.open.begin(); at != end; ++at) {
    ReadySweep out{number, at->first, 0, static_cast<int>(at->second.layers.size()), {}};
    bool prefix = true;
    for (Layer& layer : at->second.layers) {
      if (layer.has.empty()) {
        prefix = false;
        continue;
      }
      const std::size_t cost = cost_of(layer.bytes.size());
      used_ -= cost;
      shared_.used -= cost;
      prefix = prefix && layer.is_whole();
      if (!prefix) continue;
      ++out.layers;
      out.bytes.insert(out.bytes.end(), layer.bytes.begin(), layer.bytes.end());
    }
    ready.push_back(std::move(out));
  }
  stream.open.erase(stream.open.begin(), end);
  stream.last_over = sweep;
}

}  // namespace sweepcast::link
