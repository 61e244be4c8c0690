#include "common/interruption.hpp"

#include <array>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <thread>

#include "io/unfinished.hpp"

namespace sweepcast::app {
namespace {

using std::chrono::steady_clock;

/// `timeout` and its like send a signal to the process and again to its group: what comes so soon
/// after the first is the same request.
constexpr std::chrono::seconds kSameRequest{1};

constexpr std::array<int, 3> kSignals{SIGINT, SIGTERM, SIGHUP};

/// Those of them that somebody made us ignore, as nohup does.
sigset_t ignored_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : kSignals) {
    struct sigaction action {};
    if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN) {
      sigaddset(&set, signal);
    }
  }
  return set;
}

/// What the waiting thread and the command tell each other. Signals are the process's, so is this.
struct StopRequest {
  std::mutex mutex;
  std::condition_variable came;
  bool is_awaited = false;
  bool has_come = false;
  steady_clock::time_point at;  ///< when it came
};

StopRequest& stop_request() {
  static StopRequest request;
  return request;
}

/// False where the signal is to end the program.
bool take_as_request(int signal, const sigset_t& ignored) {
  StopRequest& request = stop_request();
  const std::scoped_lock lock(request.mutex);
  // A shell makes what it starts in the background ignore SIGINT; a command that goes on until it
  // is told to stop has to be told somehow.
  const bool is_heard = request.is_awaited && signal != SIGHUP;
  if (sigismember(&ignored, signal) == 1 && !is_heard) return true;
  if (!request.is_awaited) return false;
  if (request.has_come) return steady_clock::now() - request.at < kSameRequest;
  request.has_come = true;
  request.at = steady_clock::now();
  request.came.notify_all();
  return true;
}

/// A thread of its own, and no signal handler, may lock and allocate as removing needs.
[[noreturn]] void wait_for_end(const sigset_t& signals, const sigset_t& ignored) {
  int signal = 0;
  while (sigwait(&signals, &signal) != 0 || take_as_request(signal, ignored)) {
  }
  remove_unfinished();
  std::signal(signal, SIG_DFL);
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  std::raise(signal);
  std::_Exit(128 + signal);
}

}  // namespace

void stop_on_signals() {
  std::signal(SIGXFSZ, SIG_IGN);  // a file at its limit is an error of writing, as a full disk is
  const std::scoped_lock lock(stop_request().mutex);
  stop_request().is_awaited = true;
}

bool stop_requested() {
  const std::scoped_lock lock(stop_request().mutex);
  return stop_request().has_come;
}

bool wait_for_stop(std::chrono::steady_clock::time_point until) {
  StopRequest& request = stop_request();
  std::unique_lock lock(request.mutex);
  return request.came.wait_until(lock, until, [&] { return request.has_come; });
}

void remove_unfinished_on_signals() {
  const sigset_t ignored = ignored_signals();
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : kSignals) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread([signals, ignored] { wait_for_end(signals, ignored); }).detach();
}

}  // namespace sweepcast::app
