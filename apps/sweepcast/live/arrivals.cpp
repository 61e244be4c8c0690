#include "sweepcast/live/arrivals.hpp"

#include <fmt/core.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "common/command.hpp"

namespace sweepcast::app {
namespace {

constexpr std::chrono::seconds kLongestClose{10};

/// A `ReceivedSweep` that owns what it refers to.
struct Kept {
  std::string robot, sensor, name;
  std::vector<std::byte> frame;

  [[nodiscard]] ReceivedSweep view() const {
    ReceivedSweep sweep;
    sweep.robot = robot;
    sweep.sensor = sensor;
    sweep.name = name;
    sweep.frame = frame;
    return sweep;
  }
};

}  // namespace

struct Arrivals::State {
  explicit State(SweepStore sweep_store) : store(std::move(sweep_store)) {}

  SweepStore store;  // the thread's own
  mutable std::mutex mutex;
  std::condition_variable changed;
  std::deque<Kept> waiting;
  Figures figures;
  bool is_closing = false;
  bool is_failing = false;  ///< so that the same error is told once
  std::optional<Status> closed;

  void run();
  void lose(const std::string& why);
};

/// Writes until there is nothing more to come.
void Arrivals::State::run() {
  std::unique_lock lock(mutex);
  for (;;) {
    changed.wait(lock, [&] { return is_closing || !waiting.empty(); });
    if (waiting.empty()) break;
    const Kept sweep = std::move(waiting.front());
    waiting.pop_front();
    lock.unlock();
    const Status added = store.add(sweep.view());
    lock.lock();
    figures.waiting_bytes -= sweep.frame.size();
    if (added) {
      is_failing = false;
      ++figures.written;
    } else {
      lose(added.error().message);
    }
  }
  lock.unlock();
  const Status done = store.close();
  lock.lock();
  closed = done;
  changed.notify_all();
}

void Arrivals::State::lose(const std::string& why) {
  ++figures.lost;
  if (!is_failing) print_error(why + "; receiving goes on");
  is_failing = true;
}

Arrivals::Arrivals(SweepStore store) : state_(std::make_shared<State>(std::move(store))) {
  std::thread([state = state_] { state->run(); }).detach();
}

Arrivals::~Arrivals() {
  (void)close();
}

void Arrivals::take(const ReceivedSweep& sweep) {
  const std::scoped_lock lock(state_->mutex);
  Figures& figures = state_->figures;
  figures.bytes += sweep.frame.size();
  figures.last = fmt::format("{}/{}", sweep.robot, sweep.sensor);
  if (figures.waiting_bytes + sweep.frame.size() > kMostWaiting) {
    state_->lose("the disk takes sweeps more slowly than they come, so some are left out");
    return;
  }
  figures.waiting_bytes += sweep.frame.size();
  state_->waiting.push_back({std::string(sweep.robot),
                             std::string(sweep.sensor),
                             std::string(sweep.name),
                             {sweep.frame.begin(), sweep.frame.end()}});
  state_->changed.notify_all();
}

Status Arrivals::close() {
  std::unique_lock lock(state_->mutex);
  state_->is_closing = true;
  state_->changed.notify_all();
  state_->changed.wait_for(lock, kLongestClose, [&] { return state_->closed.has_value(); });
  if (!state_->closed) {
    return fail(ErrorCode::io, fmt::format("writing does not come to an end, {} bytes of sweeps "
                                           "are left out; what was written is whole",
                                           state_->figures.waiting_bytes));
  }
  const Figures& figures = state_->figures;
  if (!*state_->closed || figures.lost == 0) return *state_->closed;
  return fail(ErrorCode::io, fmt::format("{} of {} sweeps could not be written; those that were "
                                         "are whole",
                                         figures.lost, figures.lost + figures.written));
}

Arrivals::Figures Arrivals::figures() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->figures;
}

}  // namespace sweepcast::app
