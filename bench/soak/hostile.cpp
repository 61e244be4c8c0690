// What strangers may do to a receiver: soak_hostile PORT CONNECTIONS PACKETS connects so often with
// wrong keys and sends so many packets that are random, or mutated ones of SRT, to 127.0.0.1:PORT.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "link/key.hpp"
#include "link/srt_socket.hpp"

namespace sweepcast::link {
namespace {

/// Returns how many connections came about.
int connect_often(const SocketAddress& to, int times) {
  int connected = 0;
  for (int i = 0; i < times; ++i) {
    auto socket = make_srt_socket();
    const auto key = make_link_key(i % 2 == 0 ? "soak" : "stranger");  // drawn anew: never right
    if (!socket || !key) continue;
    const bool sound = set_option(socket->get(), SRTO_STREAMID, key->robot) &&
                       set_option(socket->get(), SRTO_PASSPHRASE, passphrase(*key));
    if (sound && srt_connect(socket->get(), to.get(), to.size) >= 0) ++connected;
  }
  return connected;
}

/// An SRT handshake's first packet, as the protocol's draft has it: version 4, induction.
std::vector<unsigned char> induction() {
  std::vector<unsigned char> packet(64);
  packet[0] = 0x80;  // a control packet, type handshake
  packet[19] = 4;    // version
  packet[23] = 2;    // extension field
  packet[30] = 5;    // MTU 1500
  packet[31] = 0xDC;
  packet[35] = 25;  // flow window
  packet[39] = 1;   // induction
  packet[43] = 77;  // socket
  return packet;
}

bool send_packets(const SocketAddress& to, int count) {
  const int udp = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (udp < 0) return false;
  std::mt19937 random(5);
  std::vector<unsigned char> packet;
  for (int i = 0; i < count; ++i) {
    if (i % 2 == 0) {
      packet.resize(1 + random() % 1472);
      for (unsigned char& byte : packet) byte = static_cast<unsigned char>(random());
    } else {
      packet = induction();
      for (int k = 0; k < 3; ++k) {
        packet[random() % packet.size()] ^= static_cast<unsigned char>(1U << (random() % 8));
      }
    }
    (void)::sendto(udp, packet.data(), packet.size(), 0, to.get(), static_cast<socklen_t>(to.size));
  }
  ::close(udp);
  return true;
}

int run(int argc, char** argv) {
  if (argc != 4) return std::fputs("soak_hostile PORT CONNECTIONS PACKETS\n", stderr), 2;
  const SrtLibrary library;
  const auto to = resolve("127.0.0.1", static_cast<std::uint16_t>(std::atoi(argv[1])));
  if (!prepare_crypto() || !to) return 1;
  const int connected = connect_often(*to, std::atoi(argv[2]));
  if (!send_packets(*to, std::atoi(argv[3]))) return 1;
  std::printf("%d of %s strangers were let in\n", connected, argv[2]);
  return connected == 0 ? 0 : 1;
}

}  // namespace
}  // namespace sweepcast::link

int main(int argc, char** argv) {
  return sweepcast::link::run(argc, argv);
}
