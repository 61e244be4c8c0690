#include "sweepcast-lab/bench_settings.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <map>
#include <string_view>
#include <utility>

#include "common/codec_options.hpp"
#include "common/validators.hpp"
#include "lab/peers/draco.hpp"
#include "lab/peers/registry.hpp"
#include "lab/peers/sweepcast_codec.hpp"
#include "sweepcast/cloud_file.hpp"
#include "sweepcast/ladder.hpp"

namespace sweepcast::app {
namespace {

namespace fs = std::filesystem;

/// The bounds that are measured where no setting of beam is chosen, metres.
constexpr std::array<double, 6> kMaxErrors{0.01, 0.02, 0.05, 0.1, 0.2, 0.4};

/// The paper's timing setting (section IV.D).
constexpr std::string_view kPaperSetting = "0.5,0.5,0.3,0.2";

Result<RcpccParams> parse_params(const std::string& text) {
  std::array<double, 4> values{};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto [next, error] = std::from_chars(at, end, values[i]);
    const bool separated = i + 1 < values.size() ? next != end && *next == ',' : next == end;
    if (error != std::errc{} || !separated) {
      return fail(ErrorCode::invalid_argument,
                  fmt::format("--params {}: not AZIMUTH,ELEVATION,THRESHOLD,QSTEP; give four "
                              "numbers separated by commas",
                              text));
    }
    at = next + 1;
  }
  return RcpccParams{values[0], values[1], values[2], values[3]};
}

bool contains(const std::vector<std::string>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool is_wanted(const std::vector<std::string>& levels, std::size_t level) {
  return contains(levels, "all") || contains(levels, std::to_string(level));
}

/// A setting of rcpcc and its label.
struct RcpccSetting {
  std::string label;
  RcpccParams params;
};

/// The chosen levels, or all of them; without any choice, all levels and the paper's setting.
Result<std::vector<RcpccSetting>> rcpcc_settings(const BenchSettings& options) {
  std::vector<RcpccSetting> settings;
  std::vector<std::string> params = options.params;
  std::vector<std::string> levels = options.levels;
  if (levels.empty() && params.empty()) {
    levels = {"all"};
    params = {std::string(kPaperSetting)};
  }
  for (std::size_t level = 0; level < kRcpccLevels.size(); ++level) {
    if (is_wanted(levels, level)) {
      settings.push_back({fmt::format("L{}", level), kRcpccLevels.at(level)});
    }
  }
  for (const std::string& text : params) {
    const auto parsed = parse_params(text);
    if (!parsed) return tl::unexpected(parsed.error());
    settings.push_back({text, *parsed});
  }
  return settings;
}

Status add_rcpcc(const BenchSettings& options, lab::Peers& peers) {
  const auto settings = rcpcc_settings(options);
  if (!settings) return tl::unexpected(settings.error());
  for (const RcpccSetting& setting : *settings) {
    EncoderOptions encoder;
    encoder.codec = CodecId::rcpcc;
    encoder.rcpcc = options.rcpcc;
    encoder.rcpcc.params = setting.params;
    auto peer = lab::make_sweepcast_peer(encoder, setting.label);
    if (!peer) return tl::unexpected(peer.error());
    peers.push_back(std::move(*peer));
  }
  return {};
}

/// A setting of beam and its label.
struct BeamSetting {
  std::string label;
  BeamOptions options;
  bool thins = false;  ///< so that there are cells to fill
};

/// Bounds, levels and budgets, of those chosen; without any choice, bounds.
std::vector<BeamSetting> beam_settings(const BenchSettings& options) {
  std::vector<BeamSetting> settings;
  std::vector<double> max_errors = options.max_errors;
  if (max_errors.empty() && options.levels.empty() && options.target_bytes.empty()) {
    max_errors.assign(kMaxErrors.begin(), kMaxErrors.end());
  }
  for (const double max_error : max_errors) {
    BeamSetting& setting = settings.emplace_back();
    setting.label = fmt::format("E {} m", max_error);
    setting.options.max_error_m = max_error;
  }
  for (std::size_t level = 0; level < kBeamLevels.size(); ++level) {
    if (!is_wanted(options.levels, level)) continue;
    BeamSetting& setting = settings.emplace_back();
    setting.label = fmt::format("L{}", level);
    setting.options.level = static_cast<int>(level);
    const auto& tolerances = kBeamLevels.at(level).tolerance_m;
    setting.thins =
        std::any_of(tolerances.begin(), tolerances.end(), [](double t) { return t > 0.0; });
  }
  for (const std::size_t bytes : options.target_bytes) {
    BeamSetting& setting = settings.emplace_back();
    setting.label = fmt::format("{} bytes", bytes);
    setting.options.target_bytes = bytes;
    setting.thins = true;
  }
  return settings;
}

Status add_beam_peer(const BeamSetting& setting, const std::string& label, bool fill,
                     lab::Peers& peers) {
  EncoderOptions encoder;
  encoder.codec = CodecId::beam;
  encoder.beam = setting.options;
  DecoderOptions decoder;
  decoder.fill = fill;
  auto peer = lab::make_sweepcast_peer(encoder, label, decoder);
  if (!peer) return tl::unexpected(peer.error());
  peers.push_back(std::move(*peer));
  return {};
}

Status add_beam(const BenchSettings& options, lab::Peers& peers) {
  for (BeamSetting& setting : beam_settings(options)) {
    for (const std::string& effort : options.efforts) {
      setting.options.effort = effort_words().at(effort);
      const std::string label = setting.label + (effort == "default" ? "" : " " + effort);
      if (Status added = add_beam_peer(setting, label, false, peers); !added) return added;
      if (!options.fill || !setting.thins) continue;
      if (Status added = add_beam_peer(setting, label + " fill", true, peers); !added) return added;
    }
  }
  return {};
}

constexpr std::string_view kBounded = "draco-bound";  // depends on the sweeps

/// Adds the ladders of the other codecs behind ours. Gives what "all" leaves out.
Result<std::vector<std::string>> add_others(const BenchSettings& options, lab::Peers& peers) {
  std::vector<std::string> names = options.peers;
  names.erase(std::remove(names.begin(), names.end(), kBounded), names.end());
  auto choice = lab::make_peers(names);
  if (!choice) return tl::unexpected(std::move(choice.error()));
  std::move(choice->peers.begin(), choice->peers.end(), std::back_inserter(peers));
  return std::move(choice->left_out);
}

void add_peer_option(CLI::App& app, std::vector<std::string>& peers) {
  std::vector<std::string> names;
  std::string help = "Other codecs, each from a ratio of about 10 to 400: ";
  for (const lab::PeerKind& kind : lab::peer_kinds()) {
    names.emplace_back(kind.name);
    help += fmt::format("{} ({}); ", kind.name, kind.what);
  }
  names.emplace_back(kBounded);
  names.emplace_back("all");
  help += fmt::format(
      "{} (Draco, at each --max-error the coarsest step that keeps every point "
      "within); all (but that, as far as they are there)",
      kBounded);
  app.add_option("--peers", peers, help)
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(items_of(names))
      ->type_name("NAME,...|all");
}

void add_beam_options(CLI::App& app, BenchSettings& options) {
  app.add_option("--max-error", options.max_errors,
                 "Settings of beam: largest errors in metres [0.01,0.02,0.05,0.1,0.2,0.4]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(number_between(0.001, 2.0))
      ->type_name("METRES");
  app.add_option("--target-bytes", options.target_bytes, "Settings of beam: bytes of a frame")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(number_between(1, 1 << 28))
      ->type_name("N");
  app.add_option("--effort", options.efforts, "Efforts of beam: fast, default, best [default]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(items_of({"fast", "default", "best"}))
      ->type_name("NAME,...");
  app.add_flag("--fill", options.fill,
               "Measure settings of beam that leave points out with these filled in as well");
}

}  // namespace

Result<lab::PeerChoice> make_peers(const BenchSettings& options) {
  lab::PeerChoice choice;
  lab::Peers& peers = choice.peers;
  if (contains(options.codecs, "rcpcc")) {
    if (const Status added = add_rcpcc(options, peers); !added) {
      return tl::unexpected(added.error());
    }
  }
  if (contains(options.codecs, "beam")) {
    if (const Status added = add_beam(options, peers); !added) {
      return tl::unexpected(added.error());
    }
  }
  auto left_out = add_others(options, peers);
  if (!left_out) return tl::unexpected(std::move(left_out.error()));
  choice.left_out = std::move(*left_out);
  return choice;
}

Status add_bounded_peers(const BenchSettings& options, std::span<const fs::path> sweeps,
                         lab::Peers& peers) {
  if (!contains(options.peers, kBounded)) return {};
  std::vector<PointCloud> clouds(sweeps.size());
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    if (Status read = read_cloud(sweeps[i], clouds[i]); !read) return read;
  }
  std::vector<double> max_errors = options.max_errors;
  if (max_errors.empty()) max_errors.assign(kMaxErrors.begin(), kMaxErrors.end());
  for (const double max_error : max_errors) {
    const auto step = lab::coarsest_draco_step(clouds, max_error);
    if (!step) return tl::unexpected(step.error());
    auto peer = lab::make_draco_peer({.step_m = *step});
    if (!peer) return tl::unexpected(peer.error());
    peers.push_back(std::move(*peer));
  }
  return {};
}

void add_bench_settings(CLI::App& app, BenchSettings& settings) {
  app.add_option("--codec", settings.codecs, "Our codecs to measure: rcpcc, beam [both]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(items_of({"rcpcc", "beam"}))
      ->type_name("NAME,...");
  app.add_option("--levels", settings.levels,
                 fmt::format("Levels of the codecs [rcpcc: all, and --params {}; beam: none]",
                             kPaperSetting))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(items_of({"0", "1", "2", "3", "4", "5", "all"}))
      ->type_name("0..5,...|all");
  app.add_option("--params", settings.params,
                 "A setting of rcpcc: steps in degrees, threshold and quantiser step in metres; "
                 "may be repeated")
      ->allow_extra_args(false)
      ->type_name("AZIMUTH,ELEVATION,THRESHOLD,QSTEP");
  add_beam_options(app, settings);
  app.add_option("--zstd", settings.rcpcc.zstd_level,
                 fmt::format("Level of zstd for all settings [{}]", RcpccOptions{}.zstd_level))
      ->check(CLI::Range(1, 22));
  add_peer_option(app, settings.peers);
}

}  // namespace sweepcast::app
