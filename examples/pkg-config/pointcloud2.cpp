// Packed records, as in the data of a ROS 2 sensor_msgs/PointCloud2, encoded without a copy.
#include <cmath>
#include <cstring>
#include <iostream>
#include <numbers>
#include <sweepcast/decoder.hpp>
#include <sweepcast/encoder.hpp>
#include <vector>

// What a driver publishes: x, y, z at 0, 4, 8; intensity at 16; ring at 20; 26 bytes a point.
constexpr std::size_t kStep = 26;

// A sensor in the middle of a ball of 12 m radius.
std::vector<std::byte> message() {
  std::vector<std::byte> data;
  for (std::uint16_t ring = 0; ring < 32; ++ring) {
    const double elevation = (ring - 16) * std::numbers::pi / 180;
    for (int column = 0; column < 900; ++column) {
      const double azimuth = column * std::numbers::pi / 450;
      const float xyz[] = {static_cast<float>(12 * std::cos(elevation) * std::cos(azimuth)),
                           static_cast<float>(12 * std::cos(elevation) * std::sin(azimuth)),
                           static_cast<float>(12 * std::sin(elevation))};
      const float intensity = 0.5F;
      data.resize(data.size() + kStep);
      std::byte* record = data.data() + data.size() - kStep;
      std::memcpy(record, xyz, sizeof xyz);
      std::memcpy(record + 16, &intensity, sizeof intensity);
      std::memcpy(record + 20, &ring, sizeof ring);
    }
  }
  return data;
}

int main() {
  using sweepcast::CloudView;
  using sweepcast::ScalarType;
  const std::vector<std::byte> data = message();
  CloudView view = CloudView::records(data, kStep, {0, ScalarType::f32}, {4, ScalarType::f32},
                                      {8, ScalarType::f32});
  view.intensity = CloudView::field(data, kStep, {16, ScalarType::f32});
  view.ring = CloudView::field(data, kStep, {20, ScalarType::u16});

  auto encoder = sweepcast::Encoder::create({});
  if (!encoder) return std::cerr << encoder.error().message << '\n', 1;
  const auto frame = encoder->encode(view, {.sensor = "roof"});
  if (!frame) return std::cerr << frame.error().message << '\n', 1;

  sweepcast::Decoder decoder;
  sweepcast::PointCloud cloud;
  const auto status = decoder.decode(*frame, cloud);
  if (!status) return std::cerr << status.error().message << '\n', 1;

  double worst = 0;  // range error, metres
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double range = std::hypot(cloud.x[i], cloud.y[i], cloud.z[i]);
    worst = std::max(worst, std::abs(range - 12.0));
  }
  std::cout << view.size << " points in, " << cloud.size() << " out, " << frame->size()
            << " bytes, range error at most " << worst << " m\n";
  const bool sound = view.size == data.size() / kStep && !cloud.empty() && worst < 0.5 &&
                     decoder.last_header().sensor == "roof";
  return sound ? 0 : 1;
}
