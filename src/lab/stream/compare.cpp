#include "lab/stream/compare.hpp"

#include <algorithm>
#include <memory>
#include <set>
#include <utility>

#include "lab/stream/offline.hpp"

namespace sweepcast::lab {
namespace {

/// Whole frames of all settings: what `plan_offline` chooses from.
std::set<FrameKey> whole_frames(const FrameSet& frames) {
  std::set<FrameKey> keys;
  for (std::size_t sweep = 0; sweep < frames.sweeps(); ++sweep) {
    for (std::size_t setting = 0; setting < frames.settings(); ++setting) {
      keys.insert({sweep, setting, frames.sizes[sweep][setting].layer_ends.size()});
    }
  }
  return keys;
}

void finish(Stream& stream, const FrameSet& frames, const Trace& trace, SendOrder order) {
  for (const SweepFate& fate : stream.fates) {
    stream.qoe.push_back({quality_of(fate, frames, order), fate.queued_frames});
    stream.quality.push_back(fate.sent.layers > 0 ? frames.qualities.at(fate.sent)
                                                  : SweepQuality{});
  }
  summarise(stream.fates, frames, trace, order, stream.summary);
}

}  // namespace

Result<std::vector<Stream>> compare_streams(std::span<const std::filesystem::path> sweeps,
                                            const Trace& trace,
                                            const StreamComparison& comparison) {
  if (sweeps.empty()) return fail(ErrorCode::invalid_argument, "no sweep to stream");
  if (Status link = check(comparison.session.link); !link) return tl::unexpected(link.error());
  std::vector<std::unique_ptr<Strategy>> strategies;  // none for the limit
  for (const std::string& name : comparison.strategies) {
    if (name == kOffline) {
      strategies.push_back(nullptr);
      continue;
    }
    auto strategy = make_strategy(name, comparison.codec);
    if (!strategy) return tl::unexpected(strategy.error());
    strategies.push_back(std::move(*strategy));
  }
  FrameMaker maker(comparison.codec, {sweeps.begin(), sweeps.end()});
  const bool with_budgets =
      std::any_of(comparison.strategies.begin(), comparison.strategies.end(),
                  [](const std::string& name) { return name == "budget" || name == kOffline; });
  auto frames = maker.encode(with_budgets, comparison.on_encoded);
  if (!frames) return tl::unexpected(frames.error());

  std::vector<Stream> streams(strategies.size());
  std::set<FrameKey> keys;
  for (std::size_t i = 0; i < strategies.size(); ++i) {
    if (!strategies[i]) {
      const Status measured = maker.measure(whole_frames(*frames), *frames, comparison.on_measured);
      if (!measured) return tl::unexpected(measured.error());
      strategies[i] = make_planned(plan_offline(*frames, trace, comparison.session));
    }
    streams[i].fates = run_session(*frames, trace, comparison.session, *strategies[i]);
    keys.merge(keys_of(streams[i].fates, *frames));
  }
  const Status measured = maker.measure(keys, *frames, comparison.on_measured);
  if (!measured) return tl::unexpected(measured.error());
  for (std::size_t i = 0; i < strategies.size(); ++i) {
    StreamSummary& summary = streams[i].summary;
    summary.strategy = comparison.strategies[i];
    summary.codec = name(comparison.codec);
    summary.trace = trace.name;
    finish(streams[i], *frames, trace, strategies[i]->order());
  }
  return streams;
}

}  // namespace sweepcast::lab
