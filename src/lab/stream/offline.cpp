#include "lab/stream/offline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "rate/qoe.hpp"

namespace sweepcast::lab {
namespace {

/// Leaving the sweep out; other choices are settings.
constexpr std::size_t kSkip = ~std::size_t{0};

/// The cheapest way to a quality.
struct Option {
  std::size_t setting = kSkip;
  std::size_t bytes = 0;
};

/// [level]: level l has the quality `level_quality(l)`.
using Options = std::array<Option, kLevels>;

struct State {
  LinkPlace end;           ///< of the queue
  double value = 0.0;      ///< QoE so far, with what the frames will add to later K
  std::uint32_t from = 0;  ///< the state before, as its number among all of that sweep
  std::uint8_t level = 0;
};

/// How a state came about; kept for all sweeps.
struct Step {
  std::uint32_t from = 0;
  std::uint8_t level = 0;
};

std::vector<Options> options_of(const FrameSet& frames) {
  std::vector<Options> all(frames.sweeps());
  for (std::size_t sweep = 0; sweep < frames.sweeps(); ++sweep) {
    Options& options = all[sweep];
    for (std::size_t level = 0; level + 1 < kLevels; ++level) options[level].bytes = kSkip;
    for (std::size_t setting = 0; setting < frames.settings(); ++setting) {
      const auto& ends = frames.sizes[sweep][setting].layer_ends;
      const std::size_t level =
          setting < frames.ladder ? setting : frames.level_reached({sweep, setting, ends.size()});
      if (level >= kLevels || ends.back() >= options[level].bytes) continue;
      options[level] = {setting, ends.back()};
    }
  }
  return all;
}

class Planner {
 public:
  Planner(const FrameSet& frames, const Trace& trace, const SessionOptions& options)
      : frames_(frames), options_(options), sweep_options_(options_of(frames)), line_(trace) {}

  Plan run() {
    std::vector<State> states{State{}};
    for (std::size_t i = 0; i < options_.sweeps; ++i) {
      states = prune(extend(states, i));
      auto& steps = steps_.emplace_back();
      for (const State& state : states) steps.push_back({state.from, state.level});
    }
    return trace_back(states);
  }

 private:
  std::int64_t ready_us(std::size_t index) const {
    return std::llround(static_cast<double>(index + 1) * (1e6 / options_.rate_hz));
  }

  /// Sweeps after this one that find the frame not fully sent: the sum of its shares in K.
  double waits(std::size_t index, std::int64_t sent_us) const {
    std::size_t last = index;
    const double about = static_cast<double>(sent_us) * 1e-6 * options_.rate_hz - 2.0;
    last =
        std::clamp(about > 0.0 ? static_cast<std::size_t>(about) : 0, index, options_.sweeps - 1);
    while (last + 1 < options_.sweeps && ready_us(last + 1) <= sent_us) ++last;
    return static_cast<double>(last - index);
  }

  std::vector<State> extend(const std::vector<State>& states, std::size_t index) const {
    const LinkPlace now = line_.at(ready_us(index));
    const std::size_t sweep = index % frames_.sweeps();
    const bool with_model = index % static_cast<std::size_t>(options_.model_interval) == 0;
    std::vector<State> next;
    next.reserve(states.size() * kLevels);
    for (std::size_t level = 0; level < kLevels; ++level) {
      const Option& option = sweep_options_[sweep][level];
      if (option.setting == kSkip && option.bytes == kSkip) continue;
      const std::size_t model =
          with_model && option.setting != kSkip ? frames_.sizes[sweep][option.setting].model : 0;
      const auto bytes = static_cast<std::int64_t>(option.bytes + model);
      for (std::size_t k = 0; k < states.size(); ++k) {
        State state{std::max(states[k].end, now), states[k].value, static_cast<std::uint32_t>(k),
                    static_cast<std::uint8_t>(level)};
        state.value += level_quality(level);
        if (index > 0) {
          state.value -= std::abs(level_quality(level) - level_quality(states[k].level));
        }
        if (bytes > 0) {
          state.end = TraceLine::after(state.end, bytes);
          state.value -= kQueueWeight * waits(index, line_.sent_us(state.end));
        }
        next.push_back(state);
      }
    }
    return next;
  }

  /// Leaves out what another state makes needless.
  static std::vector<State> prune(std::vector<State> states) {
    std::sort(states.begin(), states.end(), [](const State& a, const State& b) {
      return a.end != b.end ? a.end < b.end : a.value > b.value;
    });
    std::array<double, kLevels> best{};  // of each quality, among queues that end no later
    best.fill(-1e300);
    std::erase_if(states, [&best](const State& state) {
      for (std::size_t level = 0; level < kLevels; ++level) {
        const double change = std::abs(level_quality(level) - level_quality(state.level));
        if (best[level] - change >= state.value) return true;
      }
      best[state.level] = state.value;
      return false;
    });
    return states;
  }

  Plan trace_back(const std::vector<State>& states) const {
    Plan plan(options_.sweeps);
    if (plan.empty()) return plan;
    const auto best =
        std::max_element(states.begin(), states.end(),
                         [](const State& a, const State& b) { return a.value < b.value; });
    auto at = static_cast<std::uint32_t>(best - states.begin());
    for (std::size_t i = options_.sweeps; i-- > 0;) {
      const Step& step = steps_[i][at];
      const std::size_t setting = sweep_options_[i % frames_.sweeps()][step.level].setting;
      if (setting == kSkip) {
        plan[i].skip = true;
      } else if (setting < frames_.ladder) {
        plan[i].level = setting;
      } else {
        plan[i].bytes = frames_.target_bytes[setting];
      }
      at = step.from;
    }
    return plan;
  }

  const FrameSet& frames_;
  SessionOptions options_;
  std::vector<Options> sweep_options_;
  TraceLine line_;
  std::vector<std::vector<Step>> steps_;  ///< [sweep]
};

class Planned final : public Strategy {
 public:
  explicit Planned(Plan plan) : plan_(std::move(plan)) {}
  Choice decide(const LinkView& /*view*/) override { return plan_.at(next_++); }

 private:
  Plan plan_;
  std::size_t next_ = 0;
};

}  // namespace

Plan plan_offline(const FrameSet& frames, const Trace& trace, const SessionOptions& options) {
  return Planner(frames, trace, options).run();
}

std::unique_ptr<Strategy> make_planned(Plan plan) {
  return std::make_unique<Planned>(std::move(plan));
}

}  // namespace sweepcast::lab
