#include "common/input_checks.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sweepcast/cloud_file.hpp"

namespace sweepcast::app {

namespace {

/// Metres; sensors see less far.
constexpr float kFarthest = 1000.0F;

std::uint64_t count_implausible(const PointCloud& cloud, bool counts_not_finite) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.is_finite(i)) {
      if (counts_not_finite) ++count;
    } else if (std::max({std::abs(cloud.x[i]), std::abs(cloud.y[i]), std::abs(cloud.z[i])}) >
               kFarthest) {
      ++count;
    }
  }
  return count;
}

}  // namespace

void InputChecks::add(const std::filesystem::path& input, const PointCloud& cloud,
                      const std::vector<std::string>& skipped_fields) {
  const auto drop = [this](const std::string& field) {
    const bool is_new = std::find(dropped_.begin(), dropped_.end(), field) == dropped_.end();
    if (is_new) dropped_.push_back(field);
  };
  for (const std::string& field : skipped_fields) drop(field);
  if (!cloud.filled.empty()) drop("filled");
  points_ += cloud.size();
  // Other formats have points that are not finite where there was no return.
  implausible_ += count_implausible(cloud, cloud_format_of(input) == CloudFormat::bin);
}

std::vector<std::string> InputChecks::warnings() const {
  std::vector<std::string> warnings;
  if (!dropped_.empty()) {
    warnings.push_back(
        fmt::format("fields of the inputs that no frame keeps: {}; keep the inputs where they are "
                    "needed",
                    fmt::join(dropped_, ", ")));
  }
  if (2 * implausible_ > points_) {
    warnings.push_back(
        fmt::format("{} of {} points are farther than {:g} m or not finite; check that the inputs "
                    "are clouds, in metres",
                    implausible_, points_, kFarthest));
  }
  return warnings;
}

Status check_intensity_step(const PointCloud& cloud, double step) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  float least = kInfinity;
  float most = -kInfinity;
  for (const float value : cloud.intensity) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  if (least > most) return {};
  const double span = most > least ? double{most} - double{least} : std::abs(double{most});
  if (span == 0.0 || step <= span) return {};
  return fail(ErrorCode::invalid_argument,
              fmt::format("--intensity-step {:g} would leave nothing of its intensities, which are "
                          "{:g} to {:g}; choose a smaller step, as {:.1g}",
                          step, least, most, span / 100.0));
}

}  // namespace sweepcast::app
