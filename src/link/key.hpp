// Pre-shared keys, and what is derived from them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "sweepcast/link.hpp"

namespace sweepcast::link {

/// Readies libsodium; may be called as often as one likes. Error unsupported: the system has no
/// source of random numbers.
[[nodiscard]] Status prepare_crypto();

/// A number that one side of a connection draws, so that no session's keys come again.
using Challenge = std::array<std::uint8_t, 16>;
[[nodiscard]] Challenge draw_challenge();

/// Keys of one session, one for each direction.
struct SessionKeys {
  LinkSecret to_receiver{};
  LinkSecret to_sender{};
};

/// Both sides contribute: whoever replays one side's part of a session gets other keys. BLAKE2b,
/// keyed by the secret, of a label, the direction, the robot's name and both challenges.
[[nodiscard]] SessionKeys derive_session(const LinkKey& key, const Challenge& sender,
                                         const Challenge& receiver);

/// The passphrase of SRT's own encryption: 64 hexadecimal digits, derived from the secret.
[[nodiscard]] std::string passphrase(const LinkKey& key);

}  // namespace sweepcast::link
