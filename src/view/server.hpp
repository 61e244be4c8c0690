// The viewer's server: HTTP and WebSocket at one port, in a thread of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sweepcast/link.hpp"
#include "sweepcast/status.hpp"
#include "view/recording.hpp"
#include "view/sweep.hpp"

namespace sweepcast::view {

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< a numeric one, or "localhost"
  std::uint16_t port = 0;             ///< 0: any that is free
  std::string token;                  ///< needed at any other address than the loopback's
  std::vector<std::string> origins;   ///< further pages that may connect
  std::string title;
  double rate_hz = 10.0;  ///< sweeps a second of a recording
};

/// A sweep that a robot sent; see `ReceivedSweep`.
struct LiveSweep {
  std::string_view robot, sensor, name;
  std::span<const std::byte> frame;
  double age_s = 0;
};

/// What somebody who views asks of a robot: a level, or, with none, its sender's own choice.
struct LevelWish {
  std::string robot;
  std::optional<std::size_t> level;
};

class Server {
 public:
  /// Serves a recording, each client at its own pace; or, where it is null, what `publish` is
  /// given. Errors: invalid_argument (no numeric address, an address that is not the loopback's
  /// without a token, a token that fits no address), io (the port is taken), unsupported (built
  /// without Boost).
  [[nodiscard]] static Result<Server> start(ServerOptions options,
                                            std::unique_ptr<Recording> recording);

  Server(Server&&) noexcept;
  Server& operator=(Server&&) noexcept;
  /// Closes all connections.
  ~Server();

  /// "http://127.0.0.1:8080"; without the token.
  [[nodiscard]] std::string url() const;
  [[nodiscard]] std::uint16_t port() const noexcept;

  /// Shows a live sweep. Copies the frame and returns at once, from any thread; of sweeps of a
  /// stream that come faster than the server's thread takes them, only the newest stays.
  void publish(const LiveSweep& sweep);

  /// What the senders of all robots tell of themselves; from any thread.
  void tell(std::span<const RobotStatus> robots);
  /// What was asked since the last call, the last wish of each robot, and of no other robots than
  /// those whose senders told that they obey; from any thread.
  [[nodiscard]] std::vector<LevelWish> take_wishes();

 private:
  struct State;
  explicit Server(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace sweepcast::view
