#include "common/progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>

namespace sweepcast::app {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

Progress::Progress(std::string_view what, std::size_t total)
    : what_(what),
      total_(total),
      terminal_(isatty(STDERR_FILENO) == 1),
      begin_(steady_clock::now()),
      last_(begin_) {}

Progress::~Progress() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
}

void Progress::step(std::string_view note) {
  ++done_;
  const auto now = steady_clock::now();
  if (!terminal_ || now - begin_ < milliseconds(1000) || now - last_ < milliseconds(100)) return;
  last_ = now;
  drawn_ = true;
  const double seconds = std::chrono::duration<double>(now - begin_).count();
  const double left = seconds / static_cast<double>(done_) * static_cast<double>(total_ - done_);
  fmt::print(stderr, "\r\033[K{} {}/{}, {:.0f} s left  {}", what_, done_, total_, left, note);
  std::fflush(stderr);
}

}  // namespace sweepcast::app
