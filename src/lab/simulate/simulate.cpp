#include "lab/simulate/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/trig.hpp"
#include "lab/simulate/pulse.hpp"
#include "lab/simulate/road.hpp"
#include "lab/simulate/town.hpp"
#include "lab/simulate/traffic.hpp"

namespace sweepcast::lab {
namespace {

constexpr double kSecond = 1e9;  // nanoseconds

// One point before it is put in order.
struct Point {
  Vec3 position;
  double intensity = 0.0;
  int ring = 0;
  std::int64_t time_ns = 0;
  std::uint16_t object = 0;
};

// A beam's ray in the sensor's frame.
struct Ray {
  Vec3 origin;
  Vec3 direction;
};

// Rays by ring and shaft azimuth: of angles, only a table of whole ticks and one offset a beam.
class RayTable {
 public:
  explicit RayTable(const Sensor& sensor) : sensor_(sensor) {
    for (int tick = 0; tick < sensor.ticks_per_turn; ++tick) {
      ticks_.push_back(sin_cos(tick * sensor.tick_deg() * kDegree));
    }
    for (const Beam& beam : sensor.beams) {
      const double offset = beam.lag_ticks * sensor.tick_deg() + beam.azimuth_offset_deg;
      offsets_.push_back(sin_cos(offset * kDegree));
      level_.push_back(1.0 / std::sqrt(1.0 + beam.tan_elevation * beam.tan_elevation));
    }
  }

  [[nodiscard]] Ray ray(int ring, int tick) const {
    const auto k = static_cast<std::size_t>(ring);
    const Beam& beam = sensor_.beams[k];
    const SinCos& a = ticks_[static_cast<std::size_t>(tick)];
    const SinCos& b = offsets_[k];
    const double cosine = a.cos * b.cos - a.sin * b.sin;
    const double sine = a.sin * b.cos + a.cos * b.sin;
    return {{-beam.lateral_m * sine, beam.lateral_m * cosine, beam.height_m},
            Vec3{cosine, sine, beam.tan_elevation} * level_[k]};
  }

 private:
  const Sensor& sensor_;
  std::vector<SinCos> ticks_;
  std::vector<SinCos> offsets_;
  std::vector<double> level_;  // cosine of elevation
};

double rounded_mm(double metres) {
  return std::floor(metres * 1000.0 + 0.5) / 1000.0;
}

// As the sensor's driver, or KITTI's files, would hand the points on.
void put_in_order(const Sensor& sensor, std::vector<Point>& points) {
  if (!sensor.ring_major) return;
  std::vector<double> azimuth(points.size());
  std::vector<std::size_t> order(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double angle = arc_tangent(points[i].position.y, points[i].position.x);
    azimuth[i] = angle < 0.0 ? angle + 2.0 * kPi : angle;
    order[i] = i;
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (points[a].ring != points[b].ring) return points[a].ring < points[b].ring;
    return azimuth[a] != azimuth[b] ? azimuth[a] < azimuth[b] : a < b;
  });
  std::vector<Point> sorted;
  sorted.reserve(points.size());
  for (std::size_t i : order) sorted.push_back(points[i]);
  points = std::move(sorted);
}

PointCloud to_cloud(const std::vector<Point>& points) {
  PointCloud cloud;
  for (const Point& p : points) {
    cloud.x.push_back(static_cast<float>(p.position.x));
    cloud.y.push_back(static_cast<float>(p.position.y));
    cloud.z.push_back(static_cast<float>(p.position.z));
    cloud.intensity.push_back(static_cast<float>(p.intensity));
    cloud.ring.push_back(static_cast<std::uint16_t>(p.ring));
    cloud.time_ns.push_back(p.time_ns);
  }
  return cloud;
}

Status check(const SimulateOptions& options) {
  if (options.sweeps < 1 || options.sweeps > 100'000) {
    return fail(ErrorCode::invalid_argument,
                "sweeps: " + std::to_string(options.sweeps) + " is not in 1 to 100000");
  }
  if (options.blocks != 1 && options.blocks != 3) {
    return fail(ErrorCode::invalid_argument,
                "blocks: " + std::to_string(options.blocks) + " is neither 1 nor 3");
  }
  if (!(options.noise >= 0.0 && options.noise <= 100.0)) {
    return fail(ErrorCode::invalid_argument, "noise: the factor must be in 0 to 100");
  }
  return {};
}

}  // namespace

struct Drive::Parts {
  Parts(SimulateOptions chosen, Sensor found)
      : options(std::move(chosen)),
        sensor(std::move(found)),
        loop(options.blocks),
        town(build_town(options.seed)),
        rays(sensor) {}

  SimulateOptions options;
  Sensor sensor;
  Loop loop;
  Town town;
  RayTable rays;
  Solid world;
  std::vector<Mover> movers;

  [[nodiscard]] Pose sensor_pose(std::int64_t time_ns) const;
  [[nodiscard]] std::int64_t last_firing_ns(int index) const {
    return sensor.time_ns(sensor.first_firing(index + 1) - 1);
  }
  [[nodiscard]] Result<Solid> moving_at(std::int64_t begin_ns, std::int64_t end_ns) const;
  [[nodiscard]] std::optional<Point> pulse(std::int64_t firing, int ring, double part,
                                           const Pose& pose, const Solid& moving, int index) const;
  [[nodiscard]] std::vector<Point> cast(int index, const Solid& moving) const;
  [[nodiscard]] std::vector<SimulatedBox> boxes(const std::vector<Point>& points, int index) const;
};

// The car follows its lane, its body nods and rolls a little on its springs.
Pose Drive::Parts::sensor_pose(std::int64_t time_ns) const {
  constexpr double kNod = 0.0022;
  constexpr double kRoll = 0.0017;
  const double seconds = static_cast<double>(time_ns) / kSecond;
  Pose pose = on_road(town.terrain, loop.at(kSpeed * seconds));
  const double nod = kNod * sin_cos(2.0 * kPi * 1.3 * seconds).sin;
  const double roll = kRoll * sin_cos(2.0 * kPi * 0.9 * seconds + 1.0).sin;
  pose.x = normalized(pose.x + pose.z * nod);
  pose.z = normalized(cross(pose.x, pose.y + pose.z * roll));
  pose.y = cross(pose.z, pose.x);
  pose.origin = pose.origin + pose.z * sensor.mount_height_m;
  return pose;
}

// The movers near the sensor, from the sweep's begin to its end.
Result<Solid> Drive::Parts::moving_at(std::int64_t begin_ns, std::int64_t end_ns) const {
  Solid moving;
  const double begin = static_cast<double>(begin_ns) / kSecond;
  const double end = static_cast<double>(end_ns) / kSecond;
  const Vec3 eye = sensor_pose(begin_ns).origin;
  for (const Mover& mover : movers) {
    const Pose from = mover.at(begin, loop, town.terrain);
    if (length(from.origin - eye) > sensor.max_range_m + 10.0) continue;
    const Pose to = mover.at(end, loop, town.terrain);
    const auto base = static_cast<std::uint32_t>(moving.mesh.vertices.size());
    MeshBuilder at_begin{moving.mesh, from};
    for (std::uint32_t i = 0; i < mover.shape.vertices.size(); ++i) {
      const Vec3 p = mover.shape.vertex(i);
      at_begin.vertex(p);
      const Vec3 q = to.apply(p);
      moving.end.push_back(
          {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z)});
    }
    for (std::size_t i = 0; i < mover.shape.triangles.size(); ++i) {
      const auto& t = mover.shape.triangles[i];
      moving.mesh.triangles.push_back({base + t[0], base + t[1], base + t[2]});
      moving.mesh.surfaces.push_back(mover.shape.surfaces[i]);
    }
  }
  if (Status status = moving.commit(); !status) return tl::unexpected(std::move(status.error()));
  return moving;
}

std::optional<Point> Drive::Parts::pulse(std::int64_t firing, int ring, double part,
                                         const Pose& pose, const Solid& moving, int index) const {
  const Ray ray = rays.ray(ring, sensor.azimuth_tick(firing));
  if (meets_own_roof(ray.origin, ray.direction)) return std::nullopt;
  const Vec3 origin = pose.apply(ray.origin);
  const Vec3 direction = pose.rotate(ray.direction);
  auto impact = meet(world, origin, direction, sensor.max_range_m, 0.0);
  const double nearer = impact ? impact->range : sensor.max_range_m;
  if (auto other = meet(moving, origin, direction, nearer, part)) impact = other;
  if (!impact) return std::nullopt;
  const Random random(options.seed, 5, static_cast<std::uint64_t>(firing),
                      static_cast<std::uint64_t>(ring));
  const Beam& beam = sensor.beams[static_cast<std::size_t>(ring)];
  const auto back = echo(sensor, beam.gain, *impact, options.noise, options.dropouts, random);
  if (!back) return std::nullopt;
  Vec3 p = ray.origin + ray.direction * back->range;
  if (sensor.millimetres) p = {rounded_mm(p.x), rounded_mm(p.y), rounded_mm(p.z)};
  const std::int64_t since =
      sensor.time_ns(firing) + beam.delay_ns - sensor.time_ns(sensor.first_firing(index));
  return Point{p, back->intensity, ring, since, impact->surface.object};
}

std::vector<Point> Drive::Parts::cast(int index, const Solid& moving) const {
  const FlushDenormals mode;
  const std::int64_t first = sensor.first_firing(index);
  const std::int64_t end = sensor.first_firing(index + 1);
  const std::int64_t begin_ns = sensor.time_ns(first);
  const double span = static_cast<double>(sensor.time_ns(end) - begin_ns);
  std::vector<Point> points;
  for (std::int64_t firing = first; firing < end; ++firing) {
    const std::int64_t fired_ns = sensor.time_ns(firing);
    std::int64_t posed_ns = -1;
    Pose pose;
    for (int ring : sensor.firing_order) {
      const std::int64_t ns = fired_ns + sensor.beams[static_cast<std::size_t>(ring)].delay_ns;
      if (ns != posed_ns) pose = sensor_pose(ns);
      posed_ns = ns;
      const double part = std::min(static_cast<double>(ns - begin_ns) / span, 1.0);
      if (auto point = pulse(firing, ring, part, pose, moving, index)) points.push_back(*point);
    }
  }
  return points;
}

// Each box as its thing stood when it was met: at the middle one of its points' times.
std::vector<SimulatedBox> Drive::Parts::boxes(const std::vector<Point>& points, int index) const {
  std::map<std::uint16_t, std::vector<std::int64_t>> times;
  for (const Point& p : points) {
    if (p.object != 0) times[p.object].push_back(p.time_ns);
  }
  const std::int64_t begin_ns = sensor.time_ns(sensor.first_firing(index));
  std::vector<SimulatedBox> found;
  for (auto& [object, met] : times) {
    const auto middle = met.begin() + static_cast<std::ptrdiff_t>(met.size() / 2);
    std::nth_element(met.begin(), middle, met.end());
    const std::int64_t met_ns = begin_ns + *middle;
    const double seconds = static_cast<double>(met_ns) / kSecond;
    const std::size_t number = object - std::size_t{1};
    const bool parked = number < town.parked.size();
    const Mover* mover = parked ? nullptr : &movers[number - town.parked.size()];
    const Extent& extent = parked ? town.parked[number].extent : mover->extent;
    const Pose at = parked ? town.parked[number].pose : mover->at(seconds, loop, town.terrain);
    const Pose seen = at.relative_to(sensor_pose(met_ns));
    found.push_back({extent.kind, seen.apply({0.0, 0.0, 0.5 * extent.height}), extent.length,
                     extent.width, extent.height, arc_tangent(seen.x.y, seen.x.x),
                     static_cast<int>(met.size())});
  }
  return found;
}

Result<Drive> Drive::create(const SimulateOptions& options) {
  if (Status status = check(options); !status) return tl::unexpected(std::move(status.error()));
  auto sensor = find_sensor(options.sensor);
  if (!sensor) {
    return fail(ErrorCode::invalid_argument,
                "sensor: '" + options.sensor + "' is unknown; take hdl64, vlp16 or os1-128");
  }
  auto parts = std::make_shared<Parts>(options, std::move(*sensor));
  parts->world.mesh = std::move(parts->town.mesh);
  if (Status status = parts->world.commit(); !status) {
    return tl::unexpected(std::move(status.error()));
  }
  if (options.moving) {
    const auto parked = static_cast<std::uint16_t>(parts->town.parked.size());
    parts->movers =
        build_traffic(options.seed, parts->loop, static_cast<std::uint16_t>(parked + 1));
  }
  return Drive(std::move(parts));
}

Result<SimulatedSweep> Drive::sweep(int index) const {
  const Parts& parts = *parts_;
  const Sensor& sensor = parts.sensor;
  const std::int64_t begin_ns = sensor.time_ns(sensor.first_firing(index));
  const std::int64_t end_ns = sensor.time_ns(sensor.first_firing(index + 1));
  const auto moving = parts.moving_at(begin_ns, end_ns);
  if (!moving) return tl::unexpected(moving.error());
  std::vector<Point> points = parts.cast(index, *moving);
  put_in_order(sensor, points);
  return SimulatedSweep{to_cloud(points), sweep_pose(index).relative_to(sweep_pose(0)),
                        parts.boxes(points, index)};
}

const SimulateOptions& Drive::options() const {
  return parts_->options;
}
const Sensor& Drive::sensor() const {
  return parts_->sensor;
}
const Mesh& Drive::world() const {
  return parts_->world.mesh;
}
Pose Drive::sensor_pose(std::int64_t time_ns) const {
  return parts_->sensor_pose(time_ns);
}
Pose Drive::sweep_pose(int index) const {
  return sensor_pose(parts_->last_firing_ns(index));
}
double Drive::loop_length() const {
  return parts_->loop.length();
}

}  // namespace sweepcast::lab
