#include "link/srt_socket.hpp"

#include <netdb.h>

#include <chrono>
#include <cstring>
#include <memory>

namespace sweepcast::link {
namespace {

// Packets in flight or waiting to be repeated: 256 of 1316 bytes are a quarter of a second at
// 10 Mbit/s. More would only be stale when it arrives.
constexpr int kSendPackets = 256;
constexpr int kReceivePackets = 1024;
constexpr int kMtu = 1500;
constexpr int kUdpHead = 28;
constexpr int kReorderTolerance = 8;  // packets before a gap counts as loss; SRT adapts it
constexpr int kIdle_ms = 3000;
constexpr int kConnect_ms = 1000;
constexpr int kKeyBytes = 32;

void ignore_log(void* /*opaque*/, int /*level*/, const char* /*file*/, int /*line*/,
                const char* /*area*/, const char* /*message*/) {}

}  // namespace

SrtLibrary::SrtLibrary() {
  srt_startup();
  srt_setloghandler(nullptr, ignore_log);  // a library prints nothing
}

SrtLibrary::~SrtLibrary() {
  if (running_) srt_cleanup();
}

SrtSocket::~SrtSocket() {
  if (socket_ != SRT_INVALID_SOCK) srt_close(socket_);
}

bool set_option(SRTSOCKET socket, SRT_SOCKOPT option, const std::string& value) {
  return srt_setsockflag(socket, option, value.data(), static_cast<int>(value.size())) == 0;
}

Result<SrtSocket> make_srt_socket() {
  SrtSocket socket(srt_create_socket());
  // No periodic loss reports: with them SRT leaves the last packet of a burst lost until others
  // follow; without them it repeats by time what nobody acknowledges.
  const SRTSOCKET s = socket.get();
  const bool sound = s != SRT_INVALID_SOCK && set_option(s, SRTO_TRANSTYPE, SRTT_LIVE) &&
                     set_option(s, SRTO_TSBPDMODE, false) && set_option(s, SRTO_TLPKTDROP, false) &&
                     set_option(s, SRTO_NAKREPORT, false) && set_option(s, SRTO_LATENCY, 0) &&
                     set_option(s, SRTO_PAYLOADSIZE, static_cast<int>(kMostPacketBytes)) &&
                     set_option(s, SRTO_MAXBW, std::int64_t{-1}) &&
                     set_option(s, SRTO_LOSSMAXTTL, kReorderTolerance) &&
                     set_option(s, SRTO_FC, kReceivePackets) &&
                     set_option(s, SRTO_RCVBUF, kReceivePackets * (kMtu - kUdpHead)) &&
                     set_option(s, SRTO_SNDBUF, kSendPackets * (kMtu - kUdpHead)) &&
                     set_option(s, SRTO_PEERIDLETIMEO, kIdle_ms) &&
                     set_option(s, SRTO_CONNTIMEO, kConnect_ms) &&
                     set_option(s, SRTO_ENFORCEDENCRYPTION, true) &&
                     set_option(s, SRTO_PBKEYLEN, kKeyBytes) && set_option(s, SRTO_SNDSYN, false);
  if (sound) return socket;
  return fail(ErrorCode::unsupported,
              std::string("SRT refuses a socket (") + srt_getlasterror_str() +
                  "); it must be version 1.5 with encryption, as libsrt1.5-openssl is");
}

SrtOutcome srt_send_packet(SRTSOCKET socket, std::span<const std::byte> packet) {
  SRT_MSGCTRL control = srt_msgctrl_default;
  control.inorder = 0;  // a packet that comes late must not hold up the others
  if (srt_sendmsg2(socket, reinterpret_cast<const char*>(packet.data()),
                   static_cast<int>(packet.size()), &control) >= 0) {
    return SrtOutcome::done;
  }
  return srt_getlasterror(nullptr) == SRT_EASYNCSND ? SrtOutcome::not_now : SrtOutcome::broken;
}

std::size_t packets_under_way(SRTSOCKET socket) {
  std::size_t packets = 0;
  std::size_t bytes = 0;
  return srt_getsndbuffer(socket, &packets, &bytes) < 0 ? 0 : packets;
}

SrtOutcome srt_receive_packet(SRTSOCKET socket, std::span<std::byte> buffer,
                              std::span<const std::byte>& packet) {
  const int size =
      srt_recvmsg(socket, reinterpret_cast<char*>(buffer.data()), static_cast<int>(buffer.size()));
  if (size > 0) {
    packet = buffer.first(static_cast<std::size_t>(size));
    return SrtOutcome::done;
  }
  const int error = srt_getlasterror(nullptr);
  const bool is_early = error == SRT_EASYNCRCV || error == SRT_ETIMEOUT;
  return size < 0 && is_early ? SrtOutcome::not_now : SrtOutcome::broken;
}

Result<SocketAddress> resolve(const std::string& host, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (error != 0) {
    return fail(ErrorCode::invalid_argument, host + ": no address is known for this host (" +
                                                 gai_strerror(error) + "); check its name");
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(found, freeaddrinfo);
  SocketAddress address;
  address.size = static_cast<int>(found->ai_addrlen);
  std::memcpy(&address.storage, found->ai_addr, found->ai_addrlen);
  return address;
}

Microseconds now_us() {
  using std::chrono::duration_cast;
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return duration_cast<std::chrono::microseconds>(now).count();
}

}  // namespace sweepcast::link
