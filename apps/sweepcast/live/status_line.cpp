#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>

#include "sweepcast/live/metrics.hpp"

namespace sweepcast::app {

std::string metrics_address(const std::string& argument) {
  return argument.find(':') == std::string::npos ? "127.0.0.1:" + argument : argument;
}

StatusLine::StatusLine() : terminal_(isatty(STDERR_FILENO) == 1) {}

StatusLine::~StatusLine() {
  if (terminal_ && last_ != std::chrono::steady_clock::time_point{}) {
    fmt::print(stderr, "\r\033[K");
  }
}

void StatusLine::update(const std::function<std::string()>& text) {
  constexpr std::chrono::milliseconds kInterval{500};
  const auto now = std::chrono::steady_clock::now();
  if (!terminal_ || now - last_ < kInterval) return;
  last_ = now;
  fmt::print(stderr, "\r\033[K{}", text());
  std::fflush(stderr);
}

}  // namespace sweepcast::app
