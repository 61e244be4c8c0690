// A server: decodes what robots send, and says so, until so many sweeps have come.
//   server PORT KEYS-FILE [SWEEPS]
#include <sweepcast/decoder.hpp>
#include <sweepcast/link.hpp>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <thread>

int main(int argc, char** argv) {
  if (argc < 3) return std::fputs("server PORT KEYS-FILE [SWEEPS]\n", stderr), 2;
  auto keys = sweepcast::read_link_keys(argv[2]);
  if (!keys) return std::fprintf(stderr, "%s\n", keys.error().message.c_str()), 1;
  const int wanted = argc > 3 ? std::atoi(argv[3]) : 100;
  std::atomic<int> received = 0;
  sweepcast::Decoder decoder;
  sweepcast::PointCloud cloud;

  sweepcast::ReceiverOptions options;
  options.port = static_cast<std::uint16_t>(std::atoi(argv[1]));
  options.keys = std::move(*keys);
  options.on_sweep = [&](const sweepcast::ReceivedSweep& sweep) {
    if (!decoder.decode(sweep.frame, cloud)) return;  // every frame decodes alone
    std::printf("%.*s: %zu points, %d of %d layers, %.0f ms old\n", int(sweep.robot.size()),
                sweep.robot.data(), cloud.size(), sweep.layers, sweep.layers_made,
                sweep.age_s * 1e3);
    ++received;
  };
  const auto receiver = sweepcast::Receiver::start(std::move(options));
  if (!receiver) return std::fprintf(stderr, "%s\n", receiver.error().message.c_str()), 1;
  while (received < wanted) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  return 0;
}
