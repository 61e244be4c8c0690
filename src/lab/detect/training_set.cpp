#include "lab/detect/training_set.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <system_error>

#include "sweepcast/cloud_file.hpp"

namespace sweepcast::lab {

namespace {

namespace fs = std::filesystem;

constexpr double kPi = std::numbers::pi;
constexpr int kMinPoints = 5;  ///< of a box that the network is asked for

bool is_same_thing(const Box& a, const Box& b) {
  constexpr double kRounding = 3e-4;  // metres; files have four decimals
  return a.label == b.label && std::abs(a.length - b.length) < kRounding &&
         std::abs(a.width - b.width) < kRounding && std::abs(a.height - b.height) < kRounding;
}

std::vector<fs::path> clouds_of(const fs::path& folder) {
  std::vector<fs::path> clouds;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (cloud_format_of(at->path())) clouds.push_back(at->path());
  }
  std::sort(clouds.begin(), clouds.end());
  return clouds;
}

Status read_sweep(const fs::path& cloud, const fs::path& before, const fs::path& boxes,
                  LabelledSweep& sweep) {
  PointCloud read;
  if (Status status = read_cloud(cloud, read); !status) return status;
  const auto now = read_boxes(boxes / cloud.stem().concat(".txt"));
  if (!now) return tl::unexpected(now.error());
  const auto earlier = read_boxes(boxes / before.stem().concat(".txt"));
  if (!earlier) return tl::unexpected(earlier.error());
  sweep.x = std::move(read.x);
  sweep.y = std::move(read.y);
  sweep.z = std::move(read.z);
  sweep.at_last = *now;
  sweep.as_met = boxes_as_met(*now, *earlier);
  return {};
}

// How an example differs from its sweep.
struct Change {
  bool as_met = true;
  bool mirror = false;  ///< left and right
  double turn = 0.0;    ///< radians
  double keep = 1.0;    ///< share of the points
  double noise = 0.0;   ///< metres, of ranges
};

// Where the boxes lie at the last firing, they lag behind what was met by the sensor's motion: such
// examples are turned by little, so that it goes ahead in all of them.
Change draw_change(Random& random) {
  Change change;
  change.as_met = random.chance(0.5);
  change.mirror = random.chance(change.as_met ? 0.5 : 0.3);
  const double most = change.as_met ? 20.0 : 3.0;
  change.turn = random.uniform(-most, most) * kPi / 180.0;
  if (change.as_met) change.turn += 0.5 * kPi * random.below(4);
  if (random.chance(0.4)) change.keep = random.uniform(0.3, 1.0);
  if (random.chance(0.5)) change.noise = random.uniform(0.0, 0.06);
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

std::vector<Box> boxes_as_met(std::span<const Box> at_last, std::span<const Box> before) {
  std::vector<Box> met;
  for (const Box& box : at_last) {
    const auto old = std::find_if(before.begin(), before.end(),
                                  [&](const Box& other) { return is_same_thing(box, other); });
    if (old == before.end()) {
      met.push_back(box);
      met.back().points = 0;
      continue;
    }
    const Eigen::Vector3d motion = box.centre - old->centre;
    const double turn = std::remainder(box.yaw - old->yaw, 2.0 * kPi);
    Box moved = box;
    for (int i = 0; i < 3; ++i) {  // when it was met depends on where, a little
      const auto age = static_cast<double>(
          age_of(static_cast<float>(moved.centre.x()), static_cast<float>(moved.centre.y())));
      moved.centre = box.centre - age * motion;
      moved.yaw = box.yaw - age * turn;
    }
    met.push_back(std::move(moved));
  }
  return met;
}

Result<std::vector<LabelledSweep>> read_drive(const fs::path& drive, int stride) {
  const std::vector<fs::path> clouds = clouds_of(drive / "sweeps");
  if (clouds.size() < 2) {
    return fail(ErrorCode::not_found,
                drive.string() +
                    ": holds no two sweeps in sweeps/; give a drive that `sweepcast "
                    "simulate` made");
  }
  std::vector<LabelledSweep> sweeps;
  for (std::size_t i = 1; i < clouds.size(); i += static_cast<std::size_t>(std::max(1, stride))) {
    LabelledSweep sweep;
    if (Status read = read_sweep(clouds[i], clouds[i - 1], drive / "boxes", sweep); !read) {
      return tl::unexpected(read.error());
    }
    sweeps.push_back(std::move(sweep));
  }
  return sweeps;
}

Example make_example(const LabelledSweep& sweep, Random& random) {
  const Change change = draw_change(random);
  const auto c = static_cast<float>(std::cos(change.turn));
  const auto s = static_cast<float>(std::sin(change.turn));
  std::vector<float> x, y, z, ages;
  for (std::size_t i = 0; i < sweep.x.size(); ++i) {
    if (change.keep < 1.0 && !random.chance(change.keep)) continue;
    float px = sweep.x[i], py = sweep.y[i], pz = sweep.z[i];
    if (!change.as_met) ages.push_back(age_of(px, py));
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
  std::vector<Box> boxes = change.as_met ? sweep.as_met : sweep.at_last;
  for (Box& box : boxes) turn_box(change, box);
  return {make_pillars(x, y, z, ages), assign_targets(boxes, kMinPoints)};
}

}  // namespace sweepcast::lab
