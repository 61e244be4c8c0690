// The messages between the server and its page. docs/view.md has the protocol.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "sweepcast/status.hpp"
#include "view/figures.hpp"
#include "view/player.hpp"
#include "view/sweep.hpp"

namespace sweepcast::view {

inline constexpr std::string_view kPageProtocol = "sweepcast.view.v1";
inline constexpr std::size_t kSweepHead = 20;  ///< bytes before the name

enum class NoticeLevel : std::uint8_t { info, warning, error };

[[nodiscard]] std::string write_hello(const Show& show);
/// `time_s`: since the server's start.
[[nodiscard]] std::string write_status(double time_s, std::span<const RobotFigures> robots);
[[nodiscard]] std::string write_state(Player& player, Clock::time_point now);
[[nodiscard]] std::string write_notice(NoticeLevel level, std::string_view text);

/// What precedes a sweep's frame in its message; `now` makes its age.
[[nodiscard]] Bytes write_sweep_head(const Sweep& sweep, Clock::time_point now);

/// What a client asks for.
struct Command {
  enum class Kind : std::uint8_t { more, play, pause, seek, speed, loop, override_level };
  Kind kind = Kind::play;
  std::uint32_t number = 0;  ///< of `more` and `seek`
  double speed = 1.0;        ///< finite
  bool loop = false;
  std::string robot{};                 ///< of `override_level`
  std::optional<std::size_t> level{};  ///< of `override_level`; none: the sender's own choice
};

/// Reads a client's message. Error invalid_argument, with what is wrong with it.
[[nodiscard]] Result<Command> read_command(std::string_view text);

}  // namespace sweepcast::view
