// Every codec that we compare with, by name.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lab/peers/peer.hpp"

namespace sweepcast::lab {

/// A codec and its ladder of settings, from a ratio of about 10 to 400 on a sensor of 64 beams.
struct PeerKind {
  std::string_view name;      ///< as in "draco"
  std::string_view what;      ///< one line for people
  Result<Peers> (*ladder)();  ///< errors: unsupported, not_found: absent; how to get it
};

/// All of them. A new codec is a file beside this and a line in registry.cpp.
[[nodiscard]] std::span<const PeerKind> peer_kinds();

/// The peers of a choice of kinds.
struct PeerChoice {
  Peers peers;
  /// With "all": why each of the kinds that this build or machine does not have is left out.
  std::vector<std::string> left_out;
};

/// Makes the ladders of these kinds in the order of `peer_kinds()`; "all" stands for those that are
/// there. Errors: invalid_argument (no such kind), and, for a kind that is named, the ladder's.
[[nodiscard]] Result<PeerChoice> make_peers(std::span<const std::string> names);

}  // namespace sweepcast::lab
