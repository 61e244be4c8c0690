// A simulated drive: a spinning LiDAR on a car that goes round a procedural town.
//
// Frames: the world (x and y along the streets, z up); the sensor (x forward, y left, z up, the
// origin where the beams' shaft is). All metres. Same options, same bytes on every machine: random
// numbers are hashed integers, Embree only finds which triangle a beam meets, and everything that
// reaches a point is computed in double by + - * / and square root.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "lab/simulate/mesh.hpp"
#include "lab/simulate/sensors.hpp"
#include "sweepcast/cloud.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

struct SimulateOptions {
  std::string sensor = "hdl64";  ///< hdl64, vlp16, os1-128
  int sweeps = 10;               ///< 1 to 100,000; 10 a second
  std::uint64_t seed = 1;        ///< decides the town, the traffic and the noise
  bool moving = true;            ///< false leaves out moving cars and people
  int blocks = 3;                ///< the loop goes round 1 block (291 m) or 3 in an L (591 m)
  double noise = 1.0;            ///< multiplies the sensor's range noise; 0 gives exact ranges
  bool dropouts = true;          ///< false: every beam that meets a surface returns
};

/// A car, van or pedestrian that at least one point lies on: where it stood, seen from the sensor's
/// frame, when the beams met it, so that the raw sweep's points lie on it.
struct SimulatedBox {
  std::string_view kind;
  Vec3 middle;  ///< of the box, not of its floor
  double length = 0.0, width = 0.0, height = 0.0;
  double yaw = 0.0;  ///< radians from the sensor's x axis, counter-clockwise
  int points = 0;
};

struct SimulatedSweep {
  /// Raw: each point in the frame that the sensor had at its firing. With ring, intensity and time.
  PointCloud cloud;
  Pose pose;  ///< the sensor at the sweep's last firing, in its frame at the first sweep's last
  std::vector<SimulatedBox> boxes;
};

/// One drive. Sweeps are independent of each other and may be made in any order, by many threads.
class Drive {
 public:
  /// Builds the town. Errors: invalid_argument (an option outside its range, an unknown sensor),
  /// and Embree's.
  [[nodiscard]] static Result<Drive> create(const SimulateOptions& options);

  /// Sweep `index`, from 0 on.
  [[nodiscard]] Result<SimulatedSweep> sweep(int index) const;

  [[nodiscard]] const SimulateOptions& options() const;
  [[nodiscard]] const Sensor& sensor() const;
  /// What stands still, in the world's frame.
  [[nodiscard]] const Mesh& world() const;
  /// The sensor's frame in the world, nanoseconds from the drive's start.
  [[nodiscard]] Pose sensor_pose(std::int64_t time_ns) const;
  /// The same at a sweep's last firing.
  [[nodiscard]] Pose sweep_pose(int index) const;
  /// Metres after which the drive is where it began.
  [[nodiscard]] double loop_length() const;

 private:
  struct Parts;
  explicit Drive(std::shared_ptr<const Parts> parts) : parts_(std::move(parts)) {}
  std::shared_ptr<const Parts> parts_;
};

}  // namespace sweepcast::lab
