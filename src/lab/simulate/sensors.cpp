#include "lab/simulate/sensors.hpp"

#include <array>
#include <cstddef>
#include <numeric>

#include "core/trig.hpp"
#include "lab/random.hpp"

namespace sweepcast::lab {
namespace {

constexpr std::int64_t kTurnNs = 100'000'000;

double tangent(double degrees) {
  const SinCos angle = sin_cos(degrees * kDegree);
  return angle.sin / angle.cos;
}

std::vector<int> in_order(std::size_t count) {
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  return order;
}

// Two blocks of 32 lasers. Elevations are evenly spaced but for an assembly error, which every
// unit has its own of; lasers sit by turns left and right of the shaft; within a block the
// optics fan them out in azimuth with a period of twelve.
Sensor hdl64() {
  constexpr std::array kUpperLag{55, 30, 8, -17, 95, 70, 47, 22, 0, -25, 103, 78};
  constexpr std::array kLowerLag{64, 28, -8, -46, 124, 88, 51, 14, -22, -60, 139, 102};
  Sensor sensor;
  sensor.name = "hdl64";
  Random assembly(64);
  for (int k = 0; k < 64; ++k) {
    const bool upper = k < 32;
    const int row = upper ? k : k - 32;
    const double elevation =
        (upper ? 1.95 - 0.3435 * row : -8.95 - 0.5165 * row) + assembly.uniform(-0.07, 0.07);
    Beam beam;
    beam.tan_elevation = tangent(elevation);
    beam.height_m = upper ? 0.207 + 0.06 * beam.tan_elevation : 0.131 + 0.032 * beam.tan_elevation;
    beam.lateral_m = k % 2 == 0 ? -0.026 : 0.026;
    beam.lag_ticks = (upper ? kUpperLag : kLowerLag)[static_cast<std::size_t>(row % 12)];
    beam.azimuth_offset_deg = assembly.uniform(-0.045, 0.045);
    beam.gain = 1.0 + 0.12 * assembly.normal();
    sensor.beams.push_back(beam);
  }
  sensor.firing_order = in_order(sensor.beams.size());
  sensor.ticks_per_turn = 4000;
  sensor.period_num = 31'250'000;  // 2166.4 a turn: steps of 2 2 2 2 2 1 ticks, at times a sixth 2
  sensor.period_den = 677;
  sensor.intensity_scale = 1.2;
  sensor.range_sigma_m = 0.015;
  sensor.range_step_m = 0.002;
  sensor.reach_m = 120.0;
  sensor.min_range_m = 0.9;
  sensor.millimetres = true;
  sensor.ring_major = true;
  return sensor;
}

// Sixteen lasers fire one after the other, every 2.304 us, a sequence every 55.296 us; the order
// interleaves the lower and the upper half.
Sensor vlp16() {
  constexpr std::int64_t kLaserNs = 2304;
  constexpr std::int64_t kSequenceNs = 55296;
  Sensor sensor;
  sensor.name = "vlp16";
  sensor.ticks_per_turn = 36000;
  sensor.period_num = kSequenceNs;
  sensor.beams.resize(16);
  for (int laser = 0; laser < 16; ++laser) {
    const int ring = laser % 2 == 0 ? laser / 2 : 8 + laser / 2;
    const double elevation = -15.0 + 2.0 * ring;
    Beam& beam = sensor.beams[static_cast<std::size_t>(ring)];
    beam.tan_elevation = tangent(elevation);
    beam.height_m = -0.000747 * elevation;
    beam.delay_ns = laser * kLaserNs;
    // The shaft has turned on, clockwise, by the time this laser fires.
    beam.azimuth_offset_deg = -360.0 * static_cast<double>(beam.delay_ns) / kTurnNs;
    sensor.firing_order.push_back(ring);
  }
  sensor.range_sigma_m = 0.010;
  sensor.range_step_m = 0.002;
  sensor.reach_m = 80.0;
  sensor.min_range_m = 0.5;
  sensor.intensity_scale = 100.0;
  sensor.intensity_step = 1.0;
  sensor.intensity_max = 255.0;
  return sensor;
}

// 128 beams fire together in each of 1024 columns; four staggered columns of lasers. The pulses
// leave 15.8 mm from the axis, along the shaft's azimuth, which in a beam's own direction is a
// shift forward (it lowers or lifts the straight line z(rho)) and a small one sideways.
Sensor os1_128() {
  constexpr double kOriginM = 0.015806;
  Sensor sensor;
  sensor.name = "os1-128";
  for (int ring = 0; ring < 128; ++ring) {
    Beam beam;
    beam.tan_elevation = tangent(22.5 - 45.0 * ring / 127.0);
    beam.azimuth_offset_deg = 4.23 - 2.82 * (ring % 4);
    const SinCos offset = sin_cos(beam.azimuth_offset_deg * kDegree);
    beam.height_m = -kOriginM * offset.cos * beam.tan_elevation;
    beam.lateral_m = -kOriginM * offset.sin;
    sensor.beams.push_back(beam);
  }
  sensor.firing_order = in_order(sensor.beams.size());
  sensor.ticks_per_turn = 1024;
  sensor.period_num = kTurnNs;
  sensor.period_den = 1024;
  sensor.range_sigma_m = 0.008;
  sensor.range_step_m = 0.001;
  sensor.reach_m = 85.0;
  sensor.min_range_m = 0.5;
  sensor.intensity_scale = 150.0;
  sensor.intensity_step = 1.0;
  sensor.intensity_max = 255.0;
  return sensor;
}

}  // namespace

std::int64_t Sensor::first_firing(int sweep) const {
  return (sweep * kTurnNs * period_den + period_num - 1) / period_num;
}

std::int64_t Sensor::time_ns(std::int64_t firing) const {
  return firing * period_num / period_den;
}

int Sensor::azimuth_tick(std::int64_t firing) const {
  const std::int64_t turned = firing * ticks_per_turn * period_num / (period_den * kTurnNs);
  const std::int64_t tick = (ticks_per_turn / 2 - turned) % ticks_per_turn;
  return static_cast<int>(tick < 0 ? tick + ticks_per_turn : tick);
}

std::optional<Sensor> find_sensor(std::string_view name) {
  if (name == "hdl64") return hdl64();
  if (name == "vlp16") return vlp16();
  if (name == "os1-128") return os1_128();
  return std::nullopt;
}

}  // namespace sweepcast::lab
