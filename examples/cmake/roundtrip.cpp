// Encodes a sweep that lies in memory as an array of our own struct, and decodes it again.
#include <cmath>
#include <iostream>
#include <numbers>
#include <sweepcast/decoder.hpp>
#include <sweepcast/encoder.hpp>
#include <vector>

struct Return {  // whatever your driver gives
  double stamp;
  float x, y, z;
};

// A sensor 1.7 m above the floor of a round hall of 20 m across.
std::vector<Return> hall() {
  std::vector<Return> sweep;
  for (int beam = 0; beam < 64; ++beam) {
    const double elevation = (2.0 - 0.42 * beam) * std::numbers::pi / 180;
    const double to_floor = elevation < 0 ? 1.7 / std::tan(-elevation) : 1e9;
    const double distance = std::min(10.0, to_floor);  // along the ground
    for (int column = 0; column < 1800; ++column) {
      const double azimuth = column * std::numbers::pi / 900;
      sweep.push_back({column * 1e-4 / 1.8, static_cast<float>(distance * std::cos(azimuth)),
                       static_cast<float>(distance * std::sin(azimuth)),
                       static_cast<float>(distance * std::tan(elevation))});
    }
  }
  return sweep;
}

int main() {
  const std::vector<Return> sweep = hall();
  const auto view =
      sweepcast::CloudView::structs(std::span(sweep), &Return::x, &Return::y, &Return::z);

  auto encoder = sweepcast::Encoder::create({});
  if (!encoder) return std::cerr << encoder.error().message << '\n', 1;
  const auto frame = encoder->encode(view, {.sequence = 0, .stamp_ns = 0, .sensor = "top"});
  if (!frame) return std::cerr << frame.error().message << '\n', 1;

  sweepcast::Decoder decoder;
  sweepcast::PointCloud cloud;
  const auto status = decoder.decode(*frame, cloud);
  if (!status) return std::cerr << status.error().message << '\n', 1;

  double worst = 0;  // how far a decoded point lies from the hall's floor or wall
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double to_wall = std::abs(std::hypot(cloud.x[i], cloud.y[i]) - 10.0);
    worst = std::max(worst, std::min(to_wall, std::abs(cloud.z[i] + 1.7)));
  }
  std::cout << sweep.size() << " points in, " << cloud.size() << " out, " << frame->size()
            << " bytes, at most " << worst << " m beside the hall\n";
  const bool sound = cloud.size() == encoder->last_counts().points_coded && !cloud.empty() &&
                     frame->size() < sweep.size() && worst < 1.0;
  return sound ? 0 : 1;
}
