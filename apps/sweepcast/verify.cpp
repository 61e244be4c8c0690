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
  bool json = false;
};

/// What verifying one frame found.
struct Verified {
  std::string name;
  SweepCounts counts;
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
struct Workspace {
  std::map<std::string, fs::path> originals;  ///< by base name
  std::vector<std::byte> frame;
  PointCloud original, decoded;
  Decoder decoder;
  SweepNames names;
};

/// Checks that the numbers of points in a frame, in what it decodes to and in the original agree.
Status check_counts(const SweepCounts& counts, std::size_t original, std::size_t decoded) {
  if (!add_up(counts)) {
    return fail(ErrorCode::corrupt,
                fmt::format("{} points came in, but those coded and lost do not add up to it",
                            counts.points_in));
  }
  if (counts.points_in != original) {
    return fail(ErrorCode::corrupt,
                fmt::format("was made of {} points, and the original has {}; is it the right one?",
                            counts.points_in, original));
  }
  if (counts.points_coded == decoded) return {};
  return fail(ErrorCode::corrupt,
              fmt::format("announces {} points and decodes to {}", counts.points_coded, decoded));
}

/// Points with coordinates: organised clouds have slots without.
std::size_t count_points(const PointCloud& cloud) {
  return cloud.size() - static_cast<std::size_t>(std::count_if(
                            cloud.x.begin(), cloud.x.end(), [](float x) { return std::isnan(x); }));
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

Result<Verified> verify_one(SweepReader& reader, std::size_t i, Workspace& work) {
  Status status = reader.read(i, work.frame);
  if (status) status = work.decoder.decode(work.frame, work.decoded);
  if (!status) return tl::unexpected(status.error());
  const FrameHeader& header = work.decoder.last_header();
  const auto name = work.names.next(reader.entries()[i], header);
  if (!name) return tl::unexpected(name.error());
  const auto original = work.originals.find(*name);
  if (original == work.originals.end()) {
    return fail(ErrorCode::not_found, fmt::format("no original is named {}; add it to the folder, "
                                                  "or name the folder that has it",
                                                  *name));
  }
  status = read_cloud(original->second, work.original);
  if (status)
    status = check_counts(header.counts, work.original.size(), count_points(work.decoded));
  if (!status) return tl::unexpected(status.error());
  // Only the order tells which decoded point is which: the nearest one may be another's.
  lab::AttributeErrors attributes;
  if (keeps_order(header)) attributes = lab::attribute_errors(work.original, work.decoded);
  return Verified{*name, header.counts, lab::compare(work.original, work.decoded), attributes};
}

ordered_json frame_json(const Verified& frame) {
  return {{"name", frame.name},
          {"max_error", frame.distortion.max_o2d},
          {"mean_error", frame.distortion.mean_o2d},
          {"rms_error", frame.distortion.rms_o2d},
          {"worst_attributes", attributes_json(frame.attributes)},
          {"counts", sums_of(frame.counts).json()}};
}

void report(const VerifyOptions& options, const std::vector<Verified>& frames,
            const std::vector<std::string>& problems) {
  CountSums counts;
  ErrorSums errors;
  lab::AttributeErrors attributes;
  ordered_json list = ordered_json::array();
  for (const Verified& frame : frames) {
    counts.add(frame.counts);
    errors.add(frame.distortion);
    attributes.add(frame.attributes);
    list.push_back(frame_json(frame));
  }
  if (options.json) {
    print_json({{"ok", problems.empty()},
                {"max_error", errors.max},
                {"mean_error", errors.mean()},
                {"rms_error", errors.rms()},
                {"worst_attributes", attributes_json(attributes)},
                {"counts", counts.json()},
                {"frames", list},
                {"problems", problems}});
    return;
  }
  fmt::print("{}: {} verified\n", options.input.string(), count_of(frames.size(), "frame"));
  fmt::print("  original to nearest decoded point: max {:.3f} m, mean {:.4f} m, RMS {:.4f} m\n",
             errors.max, errors.mean(), errors.rms());
  if (const std::string text = attributes_text(attributes); !text.empty()) {
    fmt::print("  worst attribute differences: {}\n", text);
  }
  fmt::print("  {} points in, {} kept; lost: {}\n", counts.points_in(), counts.points_coded(),
             counts.losses());
}

Status verify(const VerifyOptions& options) {
  auto reader = SweepReader::open(options.input);
  if (!reader) return tl::unexpected(reader.error());
  const auto clouds = collect_clouds({options.original});
  if (!clouds) return tl::unexpected(clouds.error());
  Workspace work;
  for (const fs::path& cloud : *clouds) work.originals.emplace(cloud.stem().string(), cloud);

  std::vector<Verified> frames;
  std::vector<std::string> problems;
  const std::size_t count = reader->entries().size();
  Progress progress("verifying", count);
  for (std::size_t i = 0; i < count; ++i) {
    auto verified = verify_one(*reader, i, work);
    if (verified) {
      frames.push_back(std::move(*verified));
    } else {
      problems.push_back(frame_error(options.input, *reader, i, verified.error().message));
      print_error(problems.back());
    }
    progress.step();
  }
  report(options, frames, problems);
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
  sub->add_flag("--json", options->json, "Print the outcome as JSON, with every frame");
  sub->footer("Example: sweepcast verify drive.sweep --original drive/sweeps");
  sub->callback([options, &command] { command = [options] { return verify(*options); }; });
}

}  // namespace sweepcast::app
