// Where the sweeps of `receive` go.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "sweepcast/link.hpp"
#include "sweepcast/sweep_file.hpp"

namespace sweepcast::app {

/// Writes sweeps to one .sweep file, to DIR/robot/sensor.sweep, or to standard output. Recordings
/// that are there go on. Used by one thread at a time.
class SweepStore {
 public:
  /// `output`: a name that ends in .sweep, a folder, or "-".
  /// Errors: io, and those of `SweepWriter::open`.
  [[nodiscard]] static Result<SweepStore> open(const std::string& output);

  /// Writes a sweep. Where that fails, as on a full disk, all that was written before stays, and
  /// the next sweep is tried again. Errors: those of `SweepWriter`.
  [[nodiscard]] Status add(const ReceivedSweep& sweep);

  /// Writes the indices. Error: the first that there is.
  [[nodiscard]] Status close();

 private:
  explicit SweepStore(std::filesystem::path folder) : folder_(std::move(folder)) {}
  [[nodiscard]] Result<SweepWriter*> writer_of(const std::string& robot, const std::string& sensor);

  std::filesystem::path folder_;  ///< empty where all goes to one file
  /// By robot and sensor; by two empty names where all goes to one file.
  std::map<std::pair<std::string, std::string>, SweepWriter> writers_;
};

}  // namespace sweepcast::app
