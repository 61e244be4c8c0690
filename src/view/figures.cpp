#include "view/figures.hpp"

namespace sweepcast::view {
namespace {

/// A larger gap is a sender that began anew.
constexpr std::uint64_t kLargestGap = 1000;
/// Robots are as many as there are keys; sweeps of a window, as many as a fast sensor makes.
constexpr std::size_t kMostArrivals = 4096;

}  // namespace

void Figures::forget(Robot& robot, Clock::time_point now) {
  while (!robot.arrivals.empty() &&
         (now - robot.arrivals.front().at > kWindow || robot.arrivals.size() > kMostArrivals)) {
    robot.arrivals.pop_front();
  }
}

void Figures::add(std::string_view robot_name, std::string_view sensor, std::uint64_t sequence,
                  std::size_t bytes, double age_s, Clock::time_point now) {
  Robot& robot = robots_[std::string(robot_name)];
  const auto [next, is_first] = robot.next_sequence.try_emplace(std::string(sensor), sequence);
  const std::uint64_t gap = sequence - next->second;  // wraps where numbers go back
  if (!is_first && gap <= kLargestGap) robot.drops += gap;
  next->second = sequence + 1;
  ++robot.sweeps;
  robot.last = now;
  robot.age_s = age_s;
  robot.arrivals.push_back({now, bytes});
  forget(robot, now);
}

void Figures::tell(std::span<const RobotStatus> robots) {
  senders_.clear();
  for (const RobotStatus& robot : robots) {
    if (robot.connected && robot.report) senders_.emplace(robot.robot, *robot.report);
  }
}

bool Figures::obeys(std::string_view robot) const {
  const auto found = senders_.find(robot);
  return found != senders_.end() && found->second.can_override;
}

std::vector<RobotFigures> Figures::robots(Clock::time_point now) {
  std::vector<RobotFigures> all;
  for (auto& [name, robot] : robots_) {
    forget(robot, now);
    RobotFigures figures;
    figures.name = name;
    figures.connected = now - robot.last <= kSilence;
    figures.age_ms = robot.age_s * 1e3;
    figures.drops = robot.drops;
    figures.sweeps = robot.sweeps;
    if (const auto told = senders_.find(name); told != senders_.end()) {
      figures.sender = told->second;
    }
    double bytes = 0.0;
    for (const Arrival& arrival : robot.arrivals) bytes += static_cast<double>(arrival.bytes);
    figures.bytes_per_second = bytes / std::chrono::duration<double>(kWindow).count();
    if (!robot.arrivals.empty()) {
      figures.bytes_per_sweep = bytes / static_cast<double>(robot.arrivals.size());
    }
    all.push_back(std::move(figures));
  }
  return all;
}

}  // namespace sweepcast::view
