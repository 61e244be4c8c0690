// Figures of a running command: for Prometheus, and on one line of a terminal.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sweepcast/status.hpp"

namespace sweepcast::app {

/// One figure as of now.
struct Metric {
  std::string name;  ///< as in "sweepcast_sweeps_sent_total": counters end in _total
  std::string help;
  double value = 0;
  std::string robot{};  ///< a label, of a figure that each robot has; those follow one another
};

/// Serves figures as Prometheus text at http://ADDRESS/metrics while it lives.
class MetricsServer {
 public:
  /// `address`: "HOST:PORT". `read` is called in the server's thread, once a request.
  /// Errors: io (the port is taken), unsupported (built without prometheus-cpp).
  [[nodiscard]] static Result<MetricsServer> start(const std::string& address,
                                                   std::function<std::vector<Metric>()> read);
  MetricsServer(MetricsServer&&) noexcept;
  MetricsServer& operator=(MetricsServer&&) noexcept;
  ~MetricsServer();

 private:
  struct State;
  explicit MetricsServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// "PORT" becomes "127.0.0.1:PORT"; "HOST:PORT" stays.
[[nodiscard]] std::string metrics_address(const std::string& argument);

/// One line on standard error, drawn anew twice a second, only where that is a terminal.
class StatusLine {
 public:
  StatusLine();
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  /// Draws what `text` gives, if it is time to.
  void update(const std::function<std::string()>& text);

 private:
  bool terminal_;
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace sweepcast::app
