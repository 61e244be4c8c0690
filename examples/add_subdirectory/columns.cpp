// Columns of floats, options, where the points went, and what a damaged frame gives.
#include <cmath>
#include <iostream>
#include <limits>
#include <numbers>
#include <sweepcast/decoder.hpp>
#include <sweepcast/encoder.hpp>
#include <vector>

int main() {
  // A ring of points 5 m away, one every degree, then three that cannot be coded.
  std::vector<float> x, y, z;
  for (int degree = 0; degree < 360; ++degree) {
    x.push_back(static_cast<float>(5 * std::cos(degree * std::numbers::pi / 180)));
    y.push_back(static_cast<float>(5 * std::sin(degree * std::numbers::pi / 180)));
    z.push_back(0.0F);
  }
  for (const float odd : {0.0F, std::numeric_limits<float>::quiet_NaN(), 1e6F}) {
    x.push_back(odd);
    y.push_back(odd);
    z.push_back(odd);
  }

  sweepcast::EncoderOptions options;
  options.rcpcc.params = sweepcast::kRcpccLevels[0];  // the finest
  options.crop.max_range = 100.0F;
  auto encoder = sweepcast::Encoder::create(options);
  if (!encoder) return std::cerr << encoder.error().message << '\n', 1;
  const auto frame = encoder->encode(sweepcast::CloudView::columns(x, y, z), {});
  if (!frame) return std::cerr << frame.error().message << '\n', 1;

  const sweepcast::SweepCounts& counts = encoder->last_counts();
  std::cout << counts.points_in << " points in, " << counts.points_coded << " coded, "
            << counts.zero_range << " without a return, " << counts.not_finite << " not a number, "
            << counts.cropped << " cropped\n";
  const bool counted = counts.points_in == 363 && counts.points_coded == 360 &&
                       counts.zero_range == 1 && counts.not_finite == 1 && counts.cropped == 1;

  std::vector<std::byte> damaged(frame->begin(), frame->end());
  damaged.back() ^= std::byte{1};
  sweepcast::Decoder decoder;
  sweepcast::PointCloud cloud;
  const auto status = decoder.decode(damaged, cloud);
  if (!status) std::cout << "a damaged frame: " << status.error().message << '\n';
  const bool refused = !status && cloud.empty();
  return counted && refused ? 0 : 1;
}
