// Progress on a terminal; silence in a pipe.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>

namespace sweepcast::app {

/// One line on standard error that counts to a total. Shown only where standard error is a
/// terminal, and only from the first second on; erased at the end.
class Progress {
 public:
  Progress(std::string_view what, std::size_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// One more is done. `note` follows the count, as in the name of what comes next.
  void step(std::string_view note = {});

 private:
  std::string what_;
  std::size_t total_;
  std::size_t done_ = 0;
  bool terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace sweepcast::app
