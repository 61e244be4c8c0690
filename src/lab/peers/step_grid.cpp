#include "lab/peers/step_grid.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace sweepcast::lab {
namespace {

constexpr std::int64_t kFarthest = (kGridSteps / 2) - 1;  // steps from the sensor

}  // namespace

Result<std::uint32_t> step_um_of(double step_m, const char* what) {
  const double step_um = std::round(step_m * 1e6);
  if (!(step_um >= 1.0 && step_um <= kMaxStepUm)) {
    return fail(ErrorCode::invalid_argument,
                fmt::format("{}: a step of {} m; give one from 0.000001 to 100 m", what, step_m));
  }
  return static_cast<std::uint32_t>(step_um);
}

void to_grid(const PointCloud& cloud, std::uint32_t step_um, StepGrid& grid) {
  grid.step_um = step_um;
  const double per_metre = 1e6 / step_um;
  std::vector<std::array<std::int64_t, 3>> steps;
  steps.reserve(cloud.size());
  grid.corner = {kFarthest, kFarthest, kFarthest};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::array<double, 3> place{std::round(cloud.x[i] * per_metre),
                                      std::round(cloud.y[i] * per_metre),
                                      std::round(cloud.z[i] * per_metre)};
    const auto is_near = [](double p) { return std::abs(p) <= static_cast<double>(kFarthest); };
    if (!std::all_of(place.begin(), place.end(), is_near)) continue;
    auto& step = steps.emplace_back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      step[axis] = static_cast<std::int64_t>(place[axis]);
      grid.corner[axis] = std::min(grid.corner[axis], step[axis]);
    }
  }
  grid.cells.resize(steps.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      grid.cells[i][axis] = static_cast<std::uint32_t>(steps[i][axis] - grid.corner[axis]);
    }
  }
}

void to_cloud(const StepGrid& grid, PointCloud& cloud) {
  cloud.clear();
  cloud.resize_xyz(grid.cells.size());
  const double step = grid.step_um * 1e-6;
  const auto place = [&](std::size_t i, std::size_t axis) {
    return static_cast<float>(static_cast<double>(grid.corner[axis] + grid.cells[i][axis]) * step);
  };
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    cloud.x[i] = place(i, 0);
    cloud.y[i] = place(i, 1);
    cloud.z[i] = place(i, 2);
  }
}

void write_head(const StepGrid& grid, ByteWriter& writer) {
  writer.put_varint(grid.step_um);
  for (const std::int64_t steps : grid.corner) writer.put_signed(steps);
}

bool read_head(ByteReader& reader, StepGrid& grid) {
  grid.step_um = static_cast<std::uint32_t>(reader.get_varint(kMaxStepUm));
  for (std::int64_t& steps : grid.corner) {
    steps = reader.get_signed();
    if (steps < -kFarthest || steps > kFarthest) return false;
  }
  grid.cells.clear();
  return reader.ok() && grid.step_um > 0;
}

}  // namespace sweepcast::lab
