#include "lab/detect/training_set.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <system_error>

#include "core/trig.hpp"
#include "sweepcast/cloud_file.hpp"

namespace sweepcast::lab {

namespace {

namespace fs = std::filesystem;

constexpr int kMinPoints = 5;  ///< of a box that the network is asked for

std::vector<fs::path> clouds_of(const fs::path& folder) {
  std::vector<fs::path> clouds;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (cloud_format_of(at->path())) clouds.push_back(at->path());
  }
  std::sort(clouds.begin(), clouds.end());
  return clouds;
}

// How an example differs from its sweep.
struct Change {
  bool mirror = false;  ///< left and right
  double turn = 0.0;    ///< radians
  double keep = 1.0;    ///< share of the points
  double noise = 0.0;   ///< metres, of ranges
};

Change draw_change(Random& random) {
  Change change;
  change.mirror = random.chance(0.5);
  change.turn = random.uniform(-10.0, 10.0) * kPi / 180.0;
  if (random.chance(0.25)) change.turn = random.uniform(-kPi, kPi);
  if (random.chance(0.25)) change.keep = random.uniform(0.4, 1.0);
  if (random.chance(0.4)) change.noise = random.uniform(0.0, 0.06);
  return change;
}

void turn_box(const Change& change, Box& box) {
  if (change.mirror) {
    box.centre.y() = -box.centre.y();
    box.yaw = -box.yaw;
  }
  const double c = std::cos(change.turn), s = std::sin(change.turn);
  const double x = box.centre.x(), y = box.centre.y();
  box.centre.x() = c * x - s * y;
  box.centre.y() = s * x + c * y;
  box.yaw += change.turn;
}

}  // namespace

Result<std::vector<LabelledSweep>> read_drive(const fs::path& drive, int stride) {
  const std::vector<fs::path> clouds = clouds_of(drive / "sweeps");
  if (clouds.empty()) {
    return fail(ErrorCode::not_found, drive.string() +
                                          ": holds no sweeps in sweeps/; give a drive that "
                                          "`sweepcast simulate` made");
  }
  std::vector<LabelledSweep> sweeps;
  PointCloud cloud;
  for (std::size_t i = 0; i < clouds.size(); i += static_cast<std::size_t>(std::max(1, stride))) {
    if (Status read = read_cloud(clouds[i], cloud); !read) return tl::unexpected(read.error());
    auto boxes = read_boxes(drive / "boxes" / clouds[i].stem().concat(".txt"));
    if (!boxes) return tl::unexpected(boxes.error());
    sweeps.push_back({cloud.x, cloud.y, cloud.z, std::move(*boxes)});
  }
  return sweeps;
}

Example make_example(const LabelledSweep& sweep, Random& random) {
  const Change change = draw_change(random);
  const auto c = static_cast<float>(std::cos(change.turn));
  const auto s = static_cast<float>(std::sin(change.turn));
  std::vector<float> x, y, z;
  for (std::size_t i = 0; i < sweep.x.size(); ++i) {
    if (change.keep < 1.0 && !random.chance(change.keep)) continue;
    float px = sweep.x[i], py = sweep.y[i], pz = sweep.z[i];
    if (change.noise > 0.0) {
      const float range = std::sqrt(px * px + py * py + pz * pz);
      const float grow =
          1.0F + static_cast<float>(change.noise * random.normal()) / std::max(range, 1.0F);
      px *= grow;
      py *= grow;
      pz *= grow;
    }
    if (change.mirror) py = -py;
    x.push_back(c * px - s * py);
    y.push_back(s * px + c * py);
    z.push_back(pz);
  }
  std::vector<Box> boxes = sweep.boxes;
  for (Box& box : boxes) turn_box(change, box);
  return {make_pillars(x, y, z), assign_targets(boxes, kMinPoints)};
}

}  // namespace sweepcast::lab
