// What `sweepcast bench` measures: the codecs and settings that its command line asks for.
#pragma once

#include <CLI/CLI.hpp>

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "lab/peers/registry.hpp"
#include "sweepcast/encoder.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::app {

/// The codecs and their settings.
struct BenchSettings {
  std::vector<std::string> codecs{"rcpcc", "beam"};
  std::vector<std::string> levels;              ///< of the codecs' ladders; "all"
  std::vector<std::string> params;              ///< further settings of rcpcc
  std::vector<double> max_errors;               ///< settings of beam, metres; and Draco's bounds
  std::vector<std::size_t> target_bytes;        ///< settings of beam
  std::vector<std::string> efforts{"default"};  ///< of every setting of beam
  bool fill = false;                            ///< settings of beam that thin: filled as well
  std::vector<std::string> peers;               ///< other codecs, by name; "all"
  RcpccOptions rcpcc;                           ///< what all settings of rcpcc share
};

/// Adds the options that choose them. Parsing fills `settings`, which must outlive it.
void add_bench_settings(CLI::App& app, BenchSettings& settings);

/// Every codec at every setting, but for those that depend on the sweeps. Errors: those of the
/// codecs; invalid_argument (--params).
[[nodiscard]] Result<lab::PeerChoice> make_peers(const BenchSettings& options);

/// Adds Draco at the coarsest step that keeps each of the bounds on all sweeps, where it is asked
/// for. Errors: those of `read_cloud` and `lab::coarsest_draco_step`.
[[nodiscard]] Status add_bounded_peers(const BenchSettings& options,
                                       std::span<const std::filesystem::path> sweeps,
                                       lab::Peers& peers);

}  // namespace sweepcast::app
