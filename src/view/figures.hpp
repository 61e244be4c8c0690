// What arrives from each robot, in figures.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sweepcast/link.hpp"
#include "view/sweep.hpp"

namespace sweepcast::view {

/// A robot as of now.
struct RobotFigures {
  std::string name;
  bool connected = false;  ///< a sweep came in the last `kSilence`
  double bytes_per_second = 0.0;
  std::optional<double> bytes_per_sweep;  ///< of the last `kWindow`; none where nothing came
  double age_ms = 0.0;                    ///< of the newest sweep, when it came
  std::uint64_t drops = 0;                ///< sequence numbers that never came
  std::uint64_t sweeps = 0;
  std::optional<SenderReport> sender;  ///< what its sender tells; none where it tells nothing
};

/// So long after a stream's last sweep it counts as stopped.
inline constexpr std::chrono::seconds kSilence{2};

class Figures {
 public:
  static constexpr std::chrono::seconds kWindow{2};

  void add(std::string_view robot, std::string_view sensor, std::uint64_t sequence,
           std::size_t bytes, double age_s, Clock::time_point now);

  /// What the senders of all robots tell, in place of what they told before.
  void tell(std::span<const RobotStatus> robots);
  /// Whether the robot's sender obeys when it is asked for a level.
  [[nodiscard]] bool obeys(std::string_view robot) const;

  [[nodiscard]] std::vector<RobotFigures> robots(Clock::time_point now);

 private:
  struct Arrival {
    Clock::time_point at;
    std::size_t bytes = 0;
  };
  struct Robot {
    std::deque<Arrival> arrivals;                                     ///< of the last `kWindow`
    std::map<std::string, std::uint64_t, std::less<>> next_sequence;  ///< by sensor
    Clock::time_point last;
    double age_s = 0.0;
    std::uint64_t drops = 0;
    std::uint64_t sweeps = 0;
  };
  static void forget(Robot& robot, Clock::time_point now);

  std::map<std::string, Robot, std::less<>> robots_;
  std::map<std::string, SenderReport, std::less<>> senders_;
};

}  // namespace sweepcast::view
