#include "common/interruption.hpp"

#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <thread>

#include "io/unfinished.hpp"

namespace sweepcast::app {
namespace {

/// Whether somebody made us ignore this signal, as nohup does with SIGHUP.
bool is_ignored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

/// The signals to wait for: those that are not ignored; and SIGINT, which a shell makes the
/// programs ignore that a script starts with &, and which may be meant for them all the same.
sigset_t ending_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (signal == SIGINT || !is_ignored(signal)) sigaddset(&set, signal);
  }
  return set;
}

/// What the waiting thread and the command tell each other. Signals are the process's, so is this.
struct StopRequest {
  std::mutex mutex;
  std::condition_variable came;
  bool is_awaited = false;
  bool has_come = false;
};

StopRequest& stop_request() {
  static StopRequest request;
  return request;
}

/// False where the signal is to end the program.
bool take_as_request() {
  StopRequest& request = stop_request();
  const std::scoped_lock lock(request.mutex);
  if (!request.is_awaited || request.has_come) return false;
  request.has_come = true;
  request.came.notify_all();
  return true;
}

/// A thread of its own, and no signal handler, may lock and allocate as removing needs.
[[noreturn]] void wait_for_end(const sigset_t& signals) {
  int signal = 0;
  while (sigwait(&signals, &signal) != 0 || take_as_request() || is_ignored(signal)) {
  }
  remove_unfinished();
  std::signal(signal, SIG_DFL);
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  std::raise(signal);
  std::_Exit(128 + signal);
}

}  // namespace

void stop_on_signals() {
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
  const sigset_t signals = ending_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread([signals] { wait_for_end(signals); }).detach();
}

}  // namespace sweepcast::app
