// What is said of clouds that can be encoded, but hardly as the user means it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sweepcast/cloud.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::app {

/// Gathers over the clouds of a run what is worth a warning, so that each is given once.
class InputChecks {
 public:
  /// Takes a cloud as it was read, and the names of the fields that were skipped.
  void add(const std::filesystem::path& input, const PointCloud& cloud,
           const std::vector<std::string>& skipped_fields);

  /// Fields that some inputs have and that are not kept, in the order in which they were met.
  [[nodiscard]] const std::vector<std::string>& dropped_fields() const { return dropped_; }
  /// The warnings: sentences without an end.
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  std::vector<std::string> dropped_;
  std::uint64_t points_ = 0;
  std::uint64_t implausible_ = 0;  ///< farther than any sensor sees; in a .bin also not finite
};

/// Refuses a rounding step that is wider than all intensities of a cloud lie apart, as a step in a
/// sensor's units of 0 to 255 is where the file has 0 to 1: all of them would become one value or
/// two. Step 0 and a cloud without intensities are fine. Error invalid_argument, without a path.
[[nodiscard]] Status check_intensity_step(const PointCloud& cloud, double step);

}  // namespace sweepcast::app
