#include "link/peer.hpp"

#include <algorithm>
#include <utility>

#include "codec/frame_edit.hpp"
#include "core/crc32.hpp"
#include "link/sender_report.hpp"

namespace sweepcast::link {

Peer::Peer(const LinkKey& key, std::size_t most_bytes, MemoryBudget& shared, Microseconds now)
    : key_(key), challenge_(draw_challenge()), began_(now), reassembler_(most_bytes, shared) {
  for (std::uint8_t i = 0; i < kMostStreams; ++i) streams_[i].report.stream = i;
}

void Peer::take(std::span<const std::byte> packet, Microseconds now) {
  if (!opener_) {
    const auto theirs = read_hello(packet);
    if (!theirs) return;  // a fragment may overtake a hello that was lost and is repeated
    const SessionKeys keys = derive_session(key_, *theirs, challenge_);
    const auto types = {PacketType::fragment, PacketType::report};
    opener_.emplace(keys.to_receiver, types);
    sealer_.emplace(keys.to_sender);
    return;
  }
  std::span<const std::byte> plain;
  switch (opener_->open(packet, plain)) {
    case PacketFault::none:
      break;
    case PacketFault::forged:
      ++counts_.forged;
      return;
    case PacketFault::replayed:
      ++counts_.replayed;
      return;
    case PacketFault::truncated:
    case PacketFault::oversized:
    case PacketFault::malformed:
      ++counts_.malformed;
      return;
  }
  authentic_ = true;
  if (opener_->type() == PacketType::report) {
    take_sender_report(plain);
  } else if (const auto fragment = read_fragment(plain)) {
    take_fragment(*fragment, packet.size(), now);
  } else {
    ++counts_.malformed;
  }
}

void Peer::take_sender_report(std::span<const std::byte> plain) {
  const auto told = read_sender_report(plain);
  if (!told) {
    ++counts_.malformed;
  } else if (told->number > sender_reports_) {
    sender_reports_ = told->number;
    obeys_ = told->report.can_override;
    sender_report_ = told->report;
  }
}

void Peer::take_fragment(const Fragment& fragment, std::size_t packet_bytes, Microseconds now) {
  ++counts_.packets;
  counts_.bytes += packet_bytes;
  report_.bytes += packet_bytes;
  meter_.add(opener_->counter(), fragment.sent_us, packet_bytes, now);
  const auto delay = static_cast<std::uint32_t>(now) - fragment.sent_us;
  if (report_.fragments == 0 || wrapped_difference(delay, report_.least_delay_us) < 0) {
    report_.least_delay_us = delay;
  }
  if (!least_delay_us_ || wrapped_difference(delay, *least_delay_us_) < 0) least_delay_us_ = delay;
  if (report_.fragments == 0 || wrapped_difference(fragment.sent_us, report_.echo_us) > 0) {
    report_.echo_us = fragment.sent_us;
    newest_at_ = now;
  }
  ++report_.fragments;
  switch (reassembler_.add(fragment, now, ready_)) {
    case FragmentFate::taken:
    case FragmentFate::repeated:
      break;
    case FragmentFate::late:
      ++counts_.late;
      break;
    case FragmentFate::over_limit:
      ++counts_.over_limit;
      break;
    case FragmentFate::malformed:
      ++counts_.malformed;
      break;
  }
  finish(ready_);
}

void Peer::expire(Microseconds now) {
  reassembler_.expire(now, ready_);
  finish(ready_);
}

void Peer::finish(std::vector<ReadySweep>& ready) {
  for (ReadySweep& sweep : ready) {
    Stream& stream = streams_[sweep.stream];
    ArrivedSweep arrived;
    const bool sound = sweep.layers > 0 && restore_frame(sweep, arrived);
    stream.report.sweep = sweep.sweep;
    stream.report.layers = static_cast<std::uint8_t>(sound ? sweep.layers : 0);
    if (!sound) {
      ++counts_.missed;
      continue;
    }
    ++(sweep.layers == sweep.layers_made ? counts_.whole : counts_.cut);
    arrived_.push_back(std::move(arrived));
  }
  ready.clear();
}

/// Makes a whole frame, which decodes by itself, of what arrived.
bool Peer::restore_frame(const ReadySweep& ready, ArrivedSweep& sweep) {
  std::span<const std::byte> bytes;
  auto label = read_label(ready.bytes, bytes);
  if (!label) return false;
  Stream& stream = streams_[ready.stream];
  FrameHeader header;
  if (!parse_frame_header(bytes, header)) return false;
  const auto own = model_part(bytes, header);
  if (!own) return false;
  ModelPart what = ModelPart::keep;
  if (!own->empty()) {
    stream.model.assign(own->begin(), own->end());
    stream.report.model = crc32(*own);
  } else if (label->model != 0) {
    if (stream.report.model != label->model) return false;
    what = ModelPart::put;
  }
  sweep.layers = ready.layers;
  sweep.layers_made = ready.layers_made;
  sweep.label = std::move(*label);
  return rewrite_frame(bytes, what, stream.model, sweep.frame).has_value();
}

std::vector<ArrivedSweep> Peer::take_arrived() {
  return std::exchange(arrived_, {});
}

PeerCounts Peer::take_counts() {
  return std::exchange(counts_, {});
}

std::optional<SenderReport> Peer::take_sender_report() {
  return std::exchange(sender_report_, std::nullopt);
}

std::span<const std::byte> Peer::report(Microseconds now, LevelWish wish) {
  if (!sealer_ || now - reported_ < kReportInterval) return {};
  reported_ = now;
  ++report_.number;
  report_.busy_us = meter_.busy_us();
  report_.busy_bytes = meter_.busy_bytes();
  report_.now_us = static_cast<std::uint32_t>(now);
  report_.held_us = static_cast<std::uint32_t>(now - newest_at_);
  report_.streams.clear();
  for (const Stream& stream : streams_) {
    if (stream.report.sweep != 0) report_.streams.push_back(stream.report);
  }
  report_.wish = obeys_ ? std::optional(wish) : std::nullopt;
  write_report(report_, plain_);
  report_.fragments = 0;
  return sealer_->seal(PacketType::feedback, plain_);
}

void Peer::set_round_trip(double seconds) {
  least_round_trip_s_ = std::min(least_round_trip_s_, seconds);
}

double Peer::age_of(const ArrivedSweep& sweep, Microseconds now) const {
  const auto raw = static_cast<std::uint32_t>(now) - sweep.label.captured_us;
  const double above_least = wrapped_difference(raw, least_delay_us_.value_or(raw)) * 1e-6;
  return above_least + least_round_trip_s_ / 2.0;
}

}  // namespace sweepcast::link
