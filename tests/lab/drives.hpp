// Drives that the tests of the simulator share.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "lab/simulate/simulate.hpp"

namespace sweepcast::lab {

inline Drive make_drive(const std::string& sensor, std::uint64_t seed = 1, bool moving = true,
                        double noise = 1.0, bool dropouts = true) {
  SimulateOptions options;
  options.sensor = sensor;
  options.sweeps = 3;
  options.seed = seed;
  options.moving = moving;
  options.noise = noise;
  options.dropouts = dropouts;
  auto drive = Drive::create(options);
  EXPECT_TRUE(drive) << drive.error().message;
  return std::move(*drive);
}

inline const Drive& noisy_hdl64() {
  static const Drive drive = make_drive("hdl64");
  return drive;
}

inline const Drive& exact_vlp16() {
  static const Drive drive = make_drive("vlp16", 1, false, 0.0, false);
  return drive;
}

inline SimulatedSweep sweep_of(const Drive& drive, int index) {
  auto sweep = drive.sweep(index);
  EXPECT_TRUE(sweep) << sweep.error().message;
  return std::move(*sweep);
}

inline Vec3 point(const PointCloud& cloud, std::size_t i) {
  return {static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]),
          static_cast<double>(cloud.z[i])};
}

inline std::int64_t begin_ns(const Drive& drive, int sweep) {
  return drive.sensor().time_ns(drive.sensor().first_firing(sweep));
}

}  // namespace sweepcast::lab
