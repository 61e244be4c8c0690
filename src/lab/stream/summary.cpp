#include "lab/stream/summary.hpp"

#include <algorithm>
#include <cmath>

namespace sweepcast::lab {
namespace {

/// A share of the values lies at or below the result, which is one of them (nearest rank).
double percentile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0.0;
  const double rank = std::ceil(share * static_cast<double>(sorted.size()));
  return sorted[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

std::vector<bool> outages(const Trace& trace, std::size_t seconds) {
  std::vector<bool> outage;
  for (const std::int64_t bytes : bytes_per_second(trace, seconds)) {
    outage.push_back(bytes < kOutageBytes);
  }
  return outage;
}

/// Ages, sorted, milliseconds.
std::vector<double> ages(std::span<const SweepFate> fates, const std::vector<bool>& outage,
                         std::int64_t end_us) {
  std::vector<std::pair<std::int64_t, std::int64_t>> decoded;  // when, and which firing
  for (const SweepFate& fate : fates) {
    if (fate.sent.layers > 0) decoded.emplace_back(fate.decoded_us, fate.ready_us);
  }
  std::sort(decoded.begin(), decoded.end());
  std::vector<double> ages;
  std::size_t next = 0;
  std::int64_t newest_us = 0;
  for (std::int64_t now_us = 0; now_us < end_us; now_us += kAgeSampleUs) {
    for (; next < decoded.size() && decoded[next].first <= now_us; ++next) {
      newest_us = std::max(newest_us, decoded[next].second);
    }
    if (outage[static_cast<std::size_t>(now_us / 1'000'000)]) continue;
    ages.push_back(static_cast<double>(now_us - newest_us) * 1e-3);
  }
  std::sort(ages.begin(), ages.end());
  return ages;
}

double delivered_in_time(std::span<const SweepFate> fates, const std::vector<bool>& outage) {
  std::size_t counted = 0;
  std::size_t in_time = 0;
  for (const SweepFate& fate : fates) {
    if (outage[static_cast<std::size_t>(fate.ready_us / 1'000'000)]) continue;
    ++counted;
    if (fate.sent.layers > 0 && fate.decoded_us - fate.ready_us <= kWantedUs) ++in_time;
  }
  return counted == 0 ? 0.0 : static_cast<double>(in_time) / static_cast<double>(counted);
}

}  // namespace

std::set<FrameKey> keys_of(std::span<const SweepFate> fates, const FrameSet& frames) {
  std::set<FrameKey> keys;
  for (const SweepFate& fate : fates) {
    if (fate.sent.layers > 0) keys.insert(fate.sent);
  }
  for (std::size_t sweep = 0; sweep < frames.sweeps(); ++sweep) {
    for (std::size_t level = 0; level < frames.ladder; ++level) {
      keys.insert({sweep, level, frames.sizes[sweep][level].layer_ends.size()});
    }
  }
  return keys;
}

double quality_of(const SweepFate& fate, const FrameSet& frames, SendOrder order) {
  if (fate.skipped) return 0.0;
  if (order == SendOrder::oldest_first && fate.sent.setting < frames.ladder) {
    return level_quality(fate.sent.setting);
  }
  if (fate.sent.layers == 0) return 0.0;
  const std::size_t level = frames.level_reached(fate.sent);
  return level < frames.ladder ? level_quality(level) : 0.0;
}

void summarise(std::span<const SweepFate> fates, const FrameSet& frames, const Trace& trace,
               SendOrder order, StreamSummary& summary) {
  summary.sweeps = fates.size();
  if (fates.empty()) return;
  const auto count = static_cast<double>(fates.size());
  const std::int64_t end_us = fates.back().ready_us;
  const std::vector<bool> outage = outages(trace, static_cast<std::size_t>(end_us / 1'000'000) + 1);
  std::vector<QoeSweep> qoe_sweeps;
  for (const SweepFate& fate : fates) {
    qoe_sweeps.push_back({quality_of(fate, frames, order), fate.queued_frames});
    summary.bytes_sent += fate.bytes;
    if (fate.sent.layers == 0) {
      ++summary.dropped;
      continue;
    }
    const SweepQuality& quality = frames.qualities.at(fate.sent);
    summary.mean_f10 += quality.f10 / count;
    summary.mean_d2 += quality.d2 / count;
  }
  summary.mean_qoe = qoe(qoe_sweeps) / count;
  const std::vector<double> sorted = ages(fates, outage, end_us);
  summary.age_p50_ms = percentile(sorted, 0.50);
  summary.age_p95_ms = percentile(sorted, 0.95);
  summary.age_p99_ms = percentile(sorted, 0.99);
  summary.delivered_150ms = delivered_in_time(fates, outage);
  const auto seconds = std::max<std::ptrdiff_t>(1, end_us / 1'000'000);
  summary.outage_share =
      static_cast<double>(std::count(
          outage.begin(), outage.begin() + std::min<std::ptrdiff_t>(seconds, std::ssize(outage)),
          true)) /
      static_cast<double>(seconds);
}

}  // namespace sweepcast::lab
