// What a user does with sweeps, as the evaluation sees it. Adding a task is a file beside this that
// implements `Task`, and a line in tasks.cpp.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sweepcast/cloud.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// One result. A name with a dot, as "f_score.0.10", is a key in an object of the part before.
struct Figure {
  std::string name;
  double value = 0.0;  ///< NaN: there is none
};
using Figures = std::vector<Figure>;

/// A decoded sweep and what it was.
struct SweepPair {
  std::size_t index = 0;  ///< of the drive's sweeps
  const PointCloud& original;
  const PointCloud& decoded;
  /// At which share of the sweep each decoded point was measured, told from its azimuth alike for
  /// every codec; empty where the drive's sweeps have no times: they are deskewed already.
  std::span<const float> when;
};

/// A task at work on the sweeps of one codec at one setting. Used by one thread at a time.
class TaskRun {
 public:
  TaskRun() = default;
  virtual ~TaskRun() = default;
  TaskRun(const TaskRun&) = delete;
  TaskRun& operator=(const TaskRun&) = delete;

  /// Takes the next sweep that the task wants; they come in the order of time.
  [[nodiscard]] virtual Status add(const SweepPair& sweep) = 0;

  /// The figures of all sweeps so far.
  [[nodiscard]] virtual Result<Figures> finish() = 0;
};

/// A task on one drive. `begin` may be called by several threads at a time.
class Task {
 public:
  Task(std::string name, std::string key, std::size_t every, std::string means = {})
      : name_(std::move(name)), key_(std::move(key)), every_(every), means_(std::move(means)) {}
  virtual ~Task() = default;
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }  ///< as in "odometry"
  /// Changes with everything but the sweeps that the figures depend on: options, truth.
  [[nodiscard]] const std::string& key() const { return key_; }
  /// Every how many sweeps it takes one, from the first on.
  [[nodiscard]] std::size_t every() const { return every_; }
  /// By what it is done, for people; empty where there is but one way.
  [[nodiscard]] const std::string& means() const { return means_; }
  [[nodiscard]] bool takes(std::size_t sweep) const { return sweep % every_ == 0; }

  [[nodiscard]] virtual Result<std::unique_ptr<TaskRun>> begin() const = 0;

 private:
  std::string name_;
  std::string key_;
  std::size_t every_;
  std::string means_;
};

using Tasks = std::vector<std::unique_ptr<const Task>>;

}  // namespace sweepcast::lab
