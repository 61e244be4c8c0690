// A relay of UDP packets that makes of this machine's loopback a link as bad as one wishes.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "link/link_model.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast {

struct RelayOptions {
  std::string listen_address = "127.0.0.1";  ///< IPv4, digits and dots
  std::uint16_t listen_port = 0;             ///< 0: any that is free
  std::string to_address = "127.0.0.1";
  std::uint16_t to_port = 0;
  Trace trace;       ///< what clients together may send; the way back is as fast as can be
  LinkOptions link;  ///< of both ways; the queue's limit is of the clients' way alone
};

struct RelayCounts {
  std::uint64_t packets_in = 0, bytes_in = 0;    ///< from clients
  std::uint64_t packets_out = 0, bytes_out = 0;  ///< ... handed on
  std::uint64_t lost = 0;                        ///< ... by chance
  std::uint64_t queue_lost = 0;                  ///< ... for want of room
  std::uint64_t packets_back = 0;                ///< handed back to clients
};

/// Takes packets of up to 64 clients and hands them on when, and if, the model says that they
/// arrive. Has a thread of its own.
class Relay {
 public:
  /// Errors: invalid_argument (an address, the model's options), io (the port is taken).
  [[nodiscard]] static Result<Relay> start(RelayOptions options);

  Relay(Relay&&) noexcept;
  Relay& operator=(Relay&&) noexcept;
  ~Relay();

  [[nodiscard]] std::uint16_t port() const noexcept;
  [[nodiscard]] RelayCounts counts() const;

 private:
  struct State;
  explicit Relay(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace sweepcast
