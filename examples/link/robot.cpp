// A robot: encodes a turning room at 10 Hz to what the link carries, and sends it.
//   robot HOST PORT KEY-FILE [SWEEPS]
#include <sweepcast/encoder.hpp>
#include <sweepcast/link.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>

int main(int argc, char** argv) {
  if (argc < 4) return std::fputs("robot HOST PORT KEY-FILE [SWEEPS]\n", stderr), 2;
  const auto keys = sweepcast::read_link_keys(argv[3]);
  if (!keys) return std::fprintf(stderr, "%s\n", keys.error().message.c_str()), 1;
  sweepcast::SenderOptions options;
  options.host = argv[1];
  options.port = static_cast<std::uint16_t>(std::atoi(argv[2]));
  options.key = keys->front();
  auto sender = sweepcast::Sender::start(options);
  if (!sender) return std::fprintf(stderr, "%s\n", sender.error().message.c_str()), 1;

  sweepcast::EncoderOptions coding;
  coding.beam.target_bytes = 8000;
  auto encoder = sweepcast::Encoder::create(coding);
  const int sweeps = argc > 4 ? std::atoi(argv[4]) : 100;
  using clock = std::chrono::steady_clock;
  auto next = clock::now();
  for (int n = 0; n < sweeps; ++n) {
    std::this_thread::sleep_until(next);
    sweepcast::PointCloud cloud;  // your driver's sweep
    for (int i = 0; i < 16 * 900; ++i) {
      const float azimuth = 6.2831853F * float(i / 16) / 900, z = 0.5F * float(i % 16) - 4;
      cloud.x.push_back((9 + 0.01F * float(n)) * std::cos(azimuth));
      cloud.y.push_back(9 * std::sin(azimuth));
      cloud.z.push_back(z);
    }
    (void)encoder->set_target_bytes(sender->choose().sweep_bytes);
    const auto frame = encoder->encode(cloud, {static_cast<std::uint64_t>(n), 0, "roof"});
    if (frame) (void)sender->send({*frame, "roof", "", next});
    next = std::max(next + std::chrono::milliseconds(100), clock::now());
  }
  sender->finish();
  return sender->status().sweeps_sent > 0 ? 0 : 1;
}
