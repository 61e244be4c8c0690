// `sweepcast verify`: a .sweep file against the clouds it was made from.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "codec/frame_edit.hpp"
#include "common/counts.hpp"
#include "common/inputs.hpp"
#include "common/progress.hpp"
#include "common/recording.hpp"
#include "lab/attribute_error.hpp"
#include "lab/distortion.hpp"
#include "sweepcast/cloud_file.hpp"
#include "sweepcast/commands.hpp"
#include "sweepcast/decoder.hpp"

namespace sweepcast::app {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct VerifyOptions {
  fs::path input;
  std::string original;
  bool fill = false;
  bool json = false;
};

/// What verifying one frame found.
struct Verified {
  std::string name;
  SweepCounts counts;
  LayerCounts layers;
  std::size_t decoded = 0;  ///< points that came, without the filled ones
  std::size_t filled = 0;
  lab::Distortion distortion;
  lab::AttributeErrors attributes;  ///< worst differences
};

/// Errors of many frames, each original point counting once.
struct ErrorSums {
  double points = 0.0, sum = 0.0, sum_squares = 0.0, max = 0.0;

  void add(const lab::Distortion& distortion) {
    const double measured = distortion.points_original - distortion.left_out_original;
    if (!std::isfinite(distortion.mean_o2d)) return;  // one of the clouds has no point
    points += measured;
    sum += measured * distortion.mean_o2d;
    sum_squares += measured * distortion.rms_o2d * distortion.rms_o2d;
    max = std::max(max, distortion.max_o2d);
  }
  [[nodiscard]] double mean() const { return points > 0 ? sum / points : 0.0; }
  [[nodiscard]] double rms() const { return points > 0 ? std::sqrt(sum_squares / points) : 0.0; }
};

/// Reads frames and their originals, with buffers that are reused.
struct VerifyWorkspace {
  std::map<std::string, fs::path> originals;  ///< by base name
  std::vector<std::byte> frame;
  PointCloud original, decoded;
  Decoder decoder;
  SweepNames names;
};

/// Checks that the numbers of points in a frame, in what it decodes to and in the original agree.
/// A frame that lost layers on its way gives fewer than it announces.
Status check_counts(const SweepCounts& counts, const LayerCounts& layers, std::size_t original,
                    std::size_t decoded) {
  if (!add_up(counts)) {
    return fail(ErrorCode::corrupt,
                fmt::format("{} points came in, but those coded and lost do not add up to it; the "
                            "encoder is at fault, encode again with another version",
                            counts.points_in));
  }
  if (counts.points_in != original) {
    return fail(ErrorCode::corrupt,
                fmt::format("was made of {} points, and the original has {}; name the folder that "
                            "it was made from",
                            counts.points_in, original));
  }
  const bool as_announced =
      layers.missing() > 0 ? decoded <= counts.points_coded : decoded == counts.points_coded;
  if (as_announced) return {};
  return fail(ErrorCode::corrupt, fmt::format("announces {} points and decodes to {}; encode again",
                                              counts.points_coded, decoded));
}

/// Points with coordinates: organised clouds have slots without.
std::size_t count_points(const PointCloud& cloud) {
  return cloud.size() - static_cast<std::size_t>(std::count_if(
                            cloud.x.begin(), cloud.x.end(), [](float x) { return std::isnan(x); }));
}

std::size_t count_filled(const PointCloud& cloud) {
  return static_cast<std::size_t>(
      std::count_if(cloud.filled.begin(), cloud.filled.end(), [](auto mark) { return mark != 0; }));
}

/// The original of this name. A recording that was decoded and encoded again has names that
/// `decode` made for sweeps that came more than once: NAME-2 and so on.
Result<fs::path> find_original(const VerifyWorkspace& work, const std::string& name) {
  auto found = work.originals.find(name);
  const std::size_t dash = name.rfind('-');
  if (found == work.originals.end() && dash != std::string::npos && dash + 1 < name.size() &&
      name.find_first_not_of("0123456789", dash + 1) == std::string::npos) {
    found = work.originals.find(name.substr(0, dash));
  }
  if (found != work.originals.end()) return found->second;
  return fail(ErrorCode::not_found, fmt::format("no original is named {}; add it to the folder, or "
                                                "name the folder that has it",
                                                name));
}

bool keeps_order(const FrameHeader& header) {
  return std::any_of(header.parts.begin(), header.parts.end(), [&](const FramePart& part) {
    return part_name(header.codec, part.kind) == "order";
  });
}

/// Worst differences of the attributes that are there.
ordered_json attributes_json(const lab::AttributeErrors& errors) {
  ordered_json json = ordered_json::object();
  if (errors.intensity) json["intensity"] = *errors.intensity;
  if (errors.ring) json["ring"] = *errors.ring;
  if (errors.time_ns) json["time_ns"] = *errors.time_ns;
  return json;
}

/// The same in words; empty where there are none.
std::string attributes_text(const lab::AttributeErrors& errors) {
  std::string text;
  const auto add = [&](const char* name, const std::optional<double>& worst, const char* unit) {
    if (worst) text += fmt::format("{}{} {:g}{}", text.empty() ? "" : ", ", name, *worst, unit);
  };
  add("intensity", errors.intensity, "");
  add("ring", errors.ring, "");
  add("time", errors.time_ns, " ns");
  return text;
}

Result<Verified> verify_one(SweepReader& reader, std::size_t i, VerifyWorkspace& work) {
  Verified verified;
  Status status = reader.read(i, work.frame);
  if (status) status = work.decoder.decode(work.frame, work.decoded);
  if (!status) return tl::unexpected(status.error());
  const FrameHeader& header = work.decoder.last_header();
  const auto source = source_name(reader.entries()[i], header);
  const auto name = work.names.next(reader.entries()[i], header);
  if (!source || !name) return tl::unexpected((source ? name : source).error());
  const auto original = find_original(work, *source);
  if (!original) return tl::unexpected(original.error());
  const auto layers = count_layers(work.frame, header);
  if (!layers) return tl::unexpected(layers.error());
  verified.name = *name;
  verified.counts = header.counts;
  verified.layers = *layers;
  verified.filled = count_filled(work.decoded);
  verified.decoded = count_points(work.decoded) - verified.filled;
  status = read_cloud(*original, work.original);
  if (status) {
    status = check_counts(header.counts, *layers, work.original.size(), verified.decoded);
  }
  if (!status) return tl::unexpected(status.error());
  // Only the order tells which decoded point is which: the nearest one may be another's.
  if (keeps_order(header) && verified.filled == 0) {
    verified.attributes = lab::attribute_errors(work.original, work.decoded);
  }
  verified.distortion = lab::compare(work.original, work.decoded);
  return verified;
}

/// What all frames add up to.
struct Totals {
  CountSums counts;
  ErrorSums errors;
  lab::AttributeErrors attributes;
  LayerSums layers;
  std::uint64_t decoded = 0, filled = 0;

  void add(const Verified& frame) {
    counts.add(frame.counts);
    errors.add(frame.distortion);
    attributes.add(frame.attributes);
    layers.add(frame.layers);
    decoded += frame.decoded;
    filled += frame.filled;
  }
  /// Points that were coded and did not come, since a link cut their layers off.
  [[nodiscard]] std::uint64_t cut() const { return counts.points_coded() - decoded; }
};

ordered_json frame_json(const Verified& frame) {
  return {{"name", frame.name},
          {"max_error", frame.distortion.max_o2d},
          {"mean_error", frame.distortion.mean_o2d},
          {"rms_error", frame.distortion.rms_o2d},
          {"worst_attributes", attributes_json(frame.attributes)},
          {"points_decoded", frame.decoded},
          {"points_filled", frame.filled},
          {"layers", frame.layers.there},
          {"layers_missing", frame.layers.missing()},
          {"counts", sums_of(frame.counts).json()}};
}

void report_json(const std::vector<Verified>& frames, const Totals& totals,
                 const std::vector<std::string>& problems) {
  ordered_json list = ordered_json::array();
  for (const Verified& frame : frames) list.push_back(frame_json(frame));
  print_json({{"ok", problems.empty()},
              {"max_error", totals.errors.max},
              {"mean_error", totals.errors.mean()},
              {"rms_error", totals.errors.rms()},
              {"worst_attributes", attributes_json(totals.attributes)},
              {"points_decoded", totals.decoded},
              {"points_filled", totals.filled},
              {"frames_cut", totals.layers.frames_cut},
              {"layers_missing", totals.layers.missing},
              {"counts", totals.counts.json()},
              {"frames", list},
              {"problems", problems}});
}

/// Says of whom the distances are, where points were left out: it is these that the largest
/// distances belong to.
void report_left_out(const Totals& totals, bool fill) {
  if (totals.counts.thinned() + totals.cut() == 0) return;
  if (fill) {
    fmt::print("    with {} interpolated in place of those left out\n",
               count_of(totals.filled, "point"));
  } else {
    fmt::print(
        "    points that were left out count too, each to the nearest one that was kept; with "
        "--fill, to the nearest one kept or interpolated\n");
  }
}

void report_text(const VerifyOptions& options, std::size_t frames, const Totals& totals) {
  fmt::print("{}: {} verified\n", options.input.string(), count_of(frames, "frame"));
  if (frames == 0) return;
  fmt::print("  original to nearest decoded point: max {:.3f} m, mean {:.4f} m, RMS {:.4f} m\n",
             totals.errors.max, totals.errors.mean(), totals.errors.rms());
  report_left_out(totals, options.fill);
  if (const std::string text = attributes_text(totals.attributes); !text.empty()) {
    fmt::print("  worst attribute differences: {}\n", text);
  }
  if (const std::string text = totals.layers.text(); !text.empty()) fmt::print("  {}\n", text);
  std::string lost = totals.counts.losses();
  if (totals.cut() > 0) {
    const std::string cut = fmt::format("{} in layers that are missing", totals.cut());
    lost = lost == "none" ? cut : lost + ", " + cut;
  }
  fmt::print("  {} points in, {} kept; lost: {}\n", totals.counts.points_in(), totals.decoded,
             lost);
}

Status verify(const VerifyOptions& options) {
  auto reader = SweepReader::open(options.input);
  if (!reader) return tl::unexpected(reader.error());
  if (options.fill) {
    Status layered = check_layered(options.input, *reader, "--fill");
    if (!layered) return layered;
  }
  const auto clouds = collect_clouds({options.original});
  if (!clouds) return tl::unexpected(clouds.error());
  VerifyWorkspace work;
  work.decoder = Decoder({.fill = options.fill});
  for (const fs::path& cloud : *clouds) work.originals.emplace(cloud.stem().string(), cloud);

  std::vector<Verified> frames;
  Totals totals;
  std::vector<std::string> problems;
  const std::size_t count = reader->entries().size();
  Progress progress("verifying", count);
  for (std::size_t i = 0; i < count; ++i) {
    auto verified = verify_one(*reader, i, work);
    if (verified) {
      totals.add(*verified);
      frames.push_back(std::move(*verified));
    } else {
      problems.push_back(frame_error(options.input, *reader, i, verified.error().message));
      print_error(problems.back());
    }
    progress.step();
  }
  const std::string nothing =
      options.input.string() + ": holds no frame, so nothing was verified; encode or record again";
  if (count == 0) problems.push_back(nothing);
  if (options.json) {
    report_json(frames, totals, problems);
  } else {
    report_text(options, frames.size(), totals);
  }
  if (count == 0) return fail(ErrorCode::corrupt, nothing);
  if (problems.empty()) return check_complete(options.input, *reader);
  return fail(ErrorCode::corrupt,
              fmt::format("{}: {} of {} failed; see above", options.input.string(), problems.size(),
                          count_of(count, "frame")));
}

}  // namespace

void add_verify(CLI::App& app, Command& command) {
  auto options = std::make_shared<VerifyOptions>();
  CLI::App* sub = app.add_subcommand("verify", "Check a .sweep file against its originals");
  sub->add_option("INPUT", options->input, "The .sweep file")->type_name("IN.sweep")->required();
  sub->add_option("--original", options->original, "The folder of clouds that it was made from")
      ->type_name("DIR")
      ->required();
  sub->add_flag("--fill", options->fill,
                "Codec beam: interpolate what a level or a byte budget left out, as decode --fill");
  sub->add_flag("--json", options->json, "Print the outcome as JSON, with every frame");
  sub->footer("Example: sweepcast verify drive.sweep --original drive/sweeps");
  sub->callback([options, &command] { command = [options] { return verify(*options); }; });
}

}  // namespace sweepcast::app
