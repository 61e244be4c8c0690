#include "common/interruption.hpp"

#include <csignal>
#include <cstdlib>
#include <thread>

#include "io/unfinished.hpp"

namespace sweepcast::app {
namespace {

/// The signals to wait for: those that nobody made us ignore, as nohup does.
sigset_t ending_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler != SIG_IGN) {
      sigaddset(&set, signal);
    }
  }
  return set;
}

/// A thread of its own, and no signal handler, may lock and allocate as removing needs.
[[noreturn]] void wait_for_end(const sigset_t& signals) {
  int signal = 0;
  while (sigwait(&signals, &signal) != 0) {
  }
  remove_unfinished();
  std::signal(signal, SIG_DFL);
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  std::raise(signal);
  std::_Exit(128 + signal);
}

}  // namespace

void remove_unfinished_on_signals() {
  const sigset_t signals = ending_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread([signals] { wait_for_end(signals); }).detach();
}

}  // namespace sweepcast::app
