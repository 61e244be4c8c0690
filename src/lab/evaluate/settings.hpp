// Which codecs are evaluated, and at which settings.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "lab/evaluate/drive.hpp"
#include "lab/peers/peer.hpp"

namespace sweepcast::lab {

/// The name of the drive as it is, 16 bytes a point.
inline constexpr std::string_view kOriginal = "original";

/// Ratios at which codecs are compared.
inline constexpr std::array<double, 5> kRatios{30, 60, 100, 200, 300};
/// Beam's finest setting, a bound of errors: metres; a ratio of about 8 on a sensor of 64 beams.
inline constexpr double kFinestErrorM = 0.002;

struct SettingOptions {
  std::vector<std::string> codecs{"beam", "rcpcc"};  ///< of ours
  std::vector<std::string> peers{"all"};             ///< names of `peer_kinds()`, "all", or none
  /// Ratios that beam is aimed at, each 1 or more; by default those of the comparison and two more.
  std::vector<double> ratios{30, 60, 100, 150, 200, 300, 400};
  /// Settings of a peer's ladder, spread over it; 0: all of them.
  std::size_t settings_each = 5;
};

/// What is evaluated; the first is the uncoded drive.
struct SettingChoice {
  Peers peers;
  std::vector<std::string> left_out;  ///< codecs and settings that cannot be had, and why
};

/// Makes the uncoded drive, our codecs (beam at a bound and at ratios, rcpcc at its levels) and the
/// peers at settings of their ladders. Errors: those of `read_cloud` and `make_peers`;
/// invalid_argument (no such codec).
[[nodiscard]] Result<SettingChoice> make_settings(const SettingOptions& options,
                                                  const DriveFiles& drive);

}  // namespace sweepcast::lab
