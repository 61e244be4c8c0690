// `sweepcast encode`: clouds in, one .sweep file out.
#include "sweepcast/encoder.hpp"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/codec_options.hpp"
#include "common/counts.hpp"
#include "common/cpu_time.hpp"
#include "common/input_checks.hpp"
#include "common/inputs.hpp"
#include "common/progress.hpp"
#include "common/recording.hpp"
#include "common/validators.hpp"
#include "sweepcast/cloud_file.hpp"
#include "sweepcast/commands.hpp"
#include "sweepcast/sweep_file.hpp"

namespace sweepcast::app {

namespace {

namespace fs = std::filesystem;

struct EncodeOptions {
  std::vector<std::string> inputs;
  fs::path output;
  EncoderOptions encoder;
  std::string sensor;
  double rate_hz = 10.0;
  bool append = false;
  bool json = false;
};

/// What became of one input.
struct Encoded {
  std::string name;
  SweepCounts counts;
  std::size_t bytes = 0;
  double encode_ms = 0.0;
};

/// Refuses an output that is named like an input, and one that would replace a file of another
/// kind: that is hardly what was meant.
Status check_output(const fs::path& output) {
  if (cloud_format_of(output)) {
    return fail(ErrorCode::invalid_argument,
                output.string() +
                    ": names a cloud, and the output is a .sweep file; end the output's name in "
                    ".sweep");
  }
  std::error_code ignored;
  const bool replaces = fs::is_regular_file(output, ignored) &&
                        fs::file_size(output, ignored) > 0 && output.extension() != ".sweep";
  if (!replaces || SweepReader::open(output)) return {};
  return fail(ErrorCode::invalid_argument,
              output.string() +
                  ": is there and is no .sweep file; remove it, or give the output another name");
}

/// The number of the first sweep to write: recordings go on counting.
Result<std::uint64_t> first_sequence(const EncodeOptions& options) {
  std::error_code ignored;
  if (!options.append || fs::file_size(options.output, ignored) == 0 || ignored) return 0;
  const auto existing = SweepReader::open(options.output);
  if (!existing) return tl::unexpected(existing.error());
  return existing->entries().size();
}

/// Refuses, before any work, inputs whose names no frame could be decoded under.
Status check_names(const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs) {
    if (is_plain_file_name(input.stem().string())) continue;
    return fail(ErrorCode::invalid_argument,
                fmt::format("{}: its name holds a control character or a backslash; rename it",
                            printable(input.string())));
  }
  return {};
}

/// What all inputs go through.
struct EncodeWorkspace {
  PointCloud cloud;
  std::vector<std::string> skipped_fields;
  InputChecks checks;
  Encoder encoder;
  SweepWriter writer;
};

Result<Encoded> encode_one(const fs::path& input, const SweepInfo& info, double intensity_step,
                           EncodeWorkspace& work) {
  Status read = read_cloud(input, work.cloud, &work.skipped_fields);
  if (!read) return tl::unexpected(read.error());
  work.checks.add(input, work.cloud, work.skipped_fields);
  if (Status step = check_intensity_step(work.cloud, intensity_step); !step) {
    return fail(step.error().code, fmt::format("{}: {}", input.string(), step.error().message));
  }
  const double begin = cpu_time_ms();
  const auto frame = work.encoder.encode(work.cloud, info);
  const double end = cpu_time_ms();
  if (!frame) {
    return fail(frame.error().code, fmt::format("{}: {}", input.string(), frame.error().message));
  }
  Encoded encoded{input.stem().string(), work.encoder.last_counts(), frame->size(), end - begin};
  if (Status written = work.writer.append(*frame, encoded.name); !written) {
    return tl::unexpected(written.error());
  }
  return encoded;
}

void report_json(const std::vector<Encoded>& frames, const EncodeWorkspace& work) {
  nlohmann::ordered_json report{{"frames", nlohmann::ordered_json::array()},
                                {"file_bytes", work.writer.size()},
                                {"dropped_fields", work.checks.dropped_fields()},
                                {"warnings", work.checks.warnings()}};
  for (const Encoded& frame : frames) {
    report["frames"].push_back({{"name", frame.name},
                                {"points_in", frame.counts.points_in},
                                {"points_coded", frame.counts.points_coded},
                                {"bytes", frame.bytes},
                                {"encode_ms", frame.encode_ms},
                                {"counts", sums_of(frame.counts).json()}});
  }
  print_json(report);
}

void report_text(const fs::path& output, const std::vector<Encoded>& frames,
                 std::uint64_t file_bytes, bool geometry_only) {
  CountSums sums;
  std::uint64_t bytes = 0;
  double milliseconds = 0.0;
  for (const Encoded& frame : frames) {
    sums.add(frame.counts);
    bytes += frame.bytes;
    milliseconds += frame.encode_ms;
  }
  const auto count = static_cast<double>(frames.size());
  fmt::print("{}: {}, {} in, {} coded\n", output.string(), count_of(frames.size(), "frame"),
             count_of(sums.points_in(), "point"), sums.points_coded());
  fmt::print("  not coded: {}\n", sums.losses());
  fmt::print("  {} bytes in frames, {} in the file; ratio {:.1f} (16 B/point, geometry {})\n",
             bytes, file_bytes, ratio(sums.points_in(), bytes),
             geometry_only ? "only" : "and what attributes there are");
  fmt::print("  {:.1f} ms of CPU time a frame\n", milliseconds / count);
}

Status encode(const EncodeOptions& options) {
  const auto inputs = collect_clouds(options.inputs);
  if (!inputs) return tl::unexpected(inputs.error());
  if (Status names = check_names(*inputs); !names) return names;
  if (Status output = check_output(options.output); !output) return output;
  const auto first = first_sequence(options);
  if (!first) return tl::unexpected(first.error());
  auto encoder = Encoder::create(options.encoder);
  if (!encoder) return tl::unexpected(encoder.error());
  const auto mode = options.append ? SweepWriter::Mode::record : SweepWriter::Mode::convert;
  auto writer = SweepWriter::open(options.output, mode);
  if (!writer) return tl::unexpected(writer.error());

  EncodeWorkspace work{{}, {}, {}, std::move(*encoder), std::move(*writer)};
  std::vector<Encoded> frames;
  Progress progress("encoding", inputs->size());
  for (const fs::path& input : *inputs) {
    const std::uint64_t sequence = *first + frames.size();
    const double stamp = std::round(static_cast<double>(sequence) * 1e9 / options.rate_hz);
    const SweepInfo info{sequence, static_cast<std::int64_t>(stamp), options.sensor};
    // Only the first sweep: a later one that is dark all over must not end a recording.
    const double step = frames.empty() ? options.encoder.beam.intensity_step : 0.0;
    auto encoded = encode_one(input, info, step, work);
    if (!encoded) return tl::unexpected(encoded.error());
    frames.push_back(std::move(*encoded));
    progress.step(input.filename().string());
  }
  if (Status closed = work.writer.close(); !closed) return closed;
  for (const std::string& warning : work.checks.warnings()) print_warning(warning);
  if (options.json) {
    report_json(frames, work);
  } else {
    const EncoderOptions& encoder_options = options.encoder;
    const bool geometry_only =
        encoder_options.codec == CodecId::rcpcc || encoder_options.beam.fields == Fields::xyz;
    report_text(options.output, frames, work.writer.size(), geometry_only);
  }
  return {};
}

}  // namespace

void add_encode(CLI::App& app, Command& command) {
  auto options = std::make_shared<EncodeOptions>();
  CLI::App* sub = app.add_subcommand("encode", "Make a .sweep file of sweeps");
  sub->add_option("INPUT", options->inputs, "Clouds (.bin, .pcd, .ply), or folders of them")
      ->required();
  sub->add_option("-o,--output", options->output, "The .sweep file to write")
      ->type_name("OUT.sweep")
      ->required();
  add_codec_options(*sub, options->encoder);
  add_crop_options(*sub, options->encoder.crop);
  sub->add_option("--sensor", options->sensor, "The sensor's name, to be put into every frame")
      ->check([](const std::string& name) {
        return name.size() <= 255 ? std::string() : std::string("longer than 255 bytes");
      })
      ->type_name("NAME");
  sub->add_option("--rate", options->rate_hz, "Sweeps per second, for the time stamps [10]")
      ->check(number_between(1e-3, 1e6))
      ->type_name("HZ");
  sub->add_flag("--append", options->append, "Add to the file, in place, as a recorder does");
  sub->add_flag("--json", options->json, "Print the outcome as JSON");
  sub->footer("Example: sweepcast encode drive/sweeps -o drive.sweep --level 2");
  sub->callback([options, sub, &command] {
    require_matching(*sub, options->encoder);
    require_valid(options->encoder);
    command = [options] { return encode(*options); };
  });
}

}  // namespace sweepcast::app
