// SRT's sockets as values. The library's own threads do the sending and receiving.
#pragma once

#include <srt/srt.h>
// After it, which it needs.
#include <srt/access_control.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "link/fragment.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::link {

/// Keeps SRT running; it counts its users itself.
class SrtLibrary {
 public:
  SrtLibrary();
  SrtLibrary(SrtLibrary&& other) noexcept : running_(std::exchange(other.running_, false)) {}
  SrtLibrary& operator=(SrtLibrary&&) = delete;
  ~SrtLibrary();

 private:
  bool running_ = true;
};

/// A socket, closed at the end of its life.
class SrtSocket {
 public:
  SrtSocket() = default;
  explicit SrtSocket(SRTSOCKET socket) noexcept : socket_(socket) {}
  SrtSocket(SrtSocket&& other) noexcept : socket_(std::exchange(other.socket_, SRT_INVALID_SOCK)) {}
  SrtSocket& operator=(SrtSocket&& other) noexcept {
    std::swap(socket_, other.socket_);
    return *this;
  }
  ~SrtSocket();

  [[nodiscard]] SRTSOCKET get() const noexcept { return socket_; }

 private:
  SRTSOCKET socket_ = SRT_INVALID_SOCK;
};

/// A socket with what both sides of a link agree on: live mode, packets handed out as they come (no
/// play-out delay), messages that end at their time to live, small buffers, encryption required.
/// Error unsupported: SRT refuses an option.
[[nodiscard]] Result<SrtSocket> make_srt_socket();

/// Sets a socket's option. False where SRT refuses.
template <class T>
[[nodiscard]] bool set_option(SRTSOCKET socket, SRT_SOCKOPT option, const T& value) {
  return srt_setsockflag(socket, option, &value, static_cast<int>(sizeof(value))) == 0;
}
[[nodiscard]] bool set_option(SRTSOCKET socket, SRT_SOCKOPT option, const std::string& value);

/// What an attempt to send or receive came to.
enum class SrtOutcome : std::uint8_t { done, not_now, broken };

/// Hands a packet to SRT, which repeats it until it has arrived. Without a time to live: SRT 1.5.1
/// loses count of its packets where it drops one that waits to be repeated, and stands still. So
/// keep what is under way small: `packets_under_way`.
[[nodiscard]] SrtOutcome srt_send_packet(SRTSOCKET socket, std::span<const std::byte> packet);
/// Packets that were handed to SRT and are not known to have arrived.
[[nodiscard]] std::size_t packets_under_way(SRTSOCKET socket);
/// Receives a packet into `buffer`; `packet` is what came.
[[nodiscard]] SrtOutcome srt_receive_packet(SRTSOCKET socket, std::span<std::byte> buffer,
                                            std::span<const std::byte>& packet);

/// The IPv4 or IPv6 address of a host and port. Error invalid_argument: it cannot be resolved.
struct SocketAddress {
  sockaddr_storage storage{};
  int size = 0;
  [[nodiscard]] const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
};
[[nodiscard]] Result<SocketAddress> resolve(const std::string& host, std::uint16_t port);

/// Microseconds of the clock that never jumps.
[[nodiscard]] Microseconds now_us();

}  // namespace sweepcast::link
