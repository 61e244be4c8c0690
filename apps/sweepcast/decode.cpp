// `sweepcast decode`: a .sweep file in, one cloud a sweep out.
#include "sweepcast/decoder.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/counts.hpp"
#include "common/cpu_time.hpp"
#include "common/progress.hpp"
#include "common/recording.hpp"
#include "sweepcast/cloud_file.hpp"
#include "sweepcast/commands.hpp"

namespace sweepcast::app {

namespace {

namespace fs = std::filesystem;

struct DecodeOptions {
  fs::path input;
  fs::path folder;
  std::string format = "bin";
  bool ascii = false;
  bool compressed = false;
  int layers = DecoderOptions{}.max_layers;
  bool fill = false;
  bool json = false;
};

/// What one frame became.
struct Decoded {
  std::string name;
  fs::path file;
  std::size_t points = 0;
  std::size_t bytes = 0;  ///< of the frame
  double decode_ms = 0.0;
};

/// Buffers that are reused from frame to frame.
struct DecodeWorkspace {
  std::vector<std::byte> frame;
  PointCloud cloud;
  Decoder decoder;
  SweepNames names;
};

CloudEncoding encoding_of(const DecodeOptions& options) {
  if (options.ascii) return CloudEncoding::ascii;
  return options.compressed ? CloudEncoding::binary_compressed : CloudEncoding::binary;
}

/// Decodes frame `i`. An error here is the frame's own: the next one may be sound.
Result<Decoded> decode_one(SweepReader& reader, std::size_t i, DecodeWorkspace& work) {
  if (Status read = reader.read(i, work.frame); !read) return tl::unexpected(read.error());
  const double begin = cpu_time_ms();
  const Status decoded = work.decoder.decode(work.frame, work.cloud);
  const double end = cpu_time_ms();
  if (!decoded) return tl::unexpected(decoded.error());
  auto name = work.names.next(reader.entries()[i], work.decoder.last_header());
  if (!name) return tl::unexpected(name.error());
  return Decoded{*name, {}, work.cloud.size(), work.frame.size(), end - begin};
}

Status make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error && fs::is_directory(folder)) return {};
  return fail(ErrorCode::io,
              fmt::format("{}: cannot be made a folder ({}); choose another place", folder.string(),
                          error ? error.message() : "something is in the way"));
}

void report_json(const DecodeOptions& options, const std::vector<Decoded>& frames,
                 const std::vector<std::string>& errors) {
  nlohmann::ordered_json report{{"folder", options.folder.string()},
                                {"frames", nlohmann::ordered_json::array()},
                                {"errors", errors}};
  for (const Decoded& frame : frames) {
    report["frames"].push_back({{"name", frame.name},
                                {"file", frame.file.string()},
                                {"points", frame.points},
                                {"bytes", frame.bytes},
                                {"decode_ms", frame.decode_ms}});
  }
  print_json(report);
}

void report_text(const DecodeOptions& options, const std::vector<Decoded>& frames) {
  std::uint64_t points = 0;
  double milliseconds = 0.0;
  for (const Decoded& frame : frames) {
    points += frame.points;
    milliseconds += frame.decode_ms;
  }
  fmt::print("{}: {}, {}\n", options.folder.string(), count_of(frames.size(), "sweep"),
             count_of(points, "point"));
  if (frames.empty()) return;
  fmt::print("  {:.1f} ms of CPU time a frame\n",
             milliseconds / static_cast<double>(frames.size()));
}

Status decode(const DecodeOptions& options) {
  auto reader = SweepReader::open(options.input);
  if (!reader) return tl::unexpected(reader.error());
  if (options.fill || options.layers < DecoderOptions{}.max_layers) {
    Status layered = check_layered(options.input, *reader, "--layers and --fill");
    if (!layered) return layered;
  }
  if (Status made = make_folder(options.folder); !made) return made;
  const CloudFormat format = *cloud_format_of("x." + options.format);

  DecodeWorkspace work;
  work.decoder = Decoder({.max_layers = options.layers, .fill = options.fill});
  std::vector<Decoded> frames;
  std::vector<std::string> errors;
  const std::size_t count = reader->entries().size();
  Progress progress("decoding", count);
  for (std::size_t i = 0; i < count; ++i) {
    auto decoded = decode_one(*reader, i, work);
    if (!decoded) {
      errors.push_back(frame_error(options.input, *reader, i, decoded.error().message));
      print_error(errors.back());
      continue;
    }
    decoded->file = options.folder / (decoded->name + "." + options.format);
    Status written = write_cloud(decoded->file, work.cloud, format, encoding_of(options));
    if (!written) return written;
    frames.push_back(std::move(*decoded));
    progress.step(frames.back().name);
  }
  if (options.json) {
    report_json(options, frames, errors);
  } else {
    report_text(options, frames);
  }
  if (!errors.empty()) {
    return fail(ErrorCode::corrupt,
                fmt::format("{}: {} of {} are damaged, the sound ones ({}) are in {}; encode or "
                            "fetch the damaged ones again",
                            options.input.string(), errors.size(), count_of(count, "frame"),
                            frames.size(), options.folder.string()));
  }
  return check_complete(options.input, *reader);
}

}  // namespace

void add_decode(CLI::App& app, Command& command) {
  auto options = std::make_shared<DecodeOptions>();
  CLI::App* sub = app.add_subcommand("decode", "Give the sweeps of a .sweep file back as clouds");
  sub->add_option("INPUT", options->input, "The .sweep file")->type_name("IN.sweep")->required();
  sub->add_option("-o,--output", options->folder, "The folder to write into; made where absent")
      ->type_name("DIR")
      ->required();
  sub->add_option("--format", options->format, "Format of the clouds [bin]")
      ->check(CLI::IsMember({"bin", "pcd", "ply"}).description(""))
      ->type_name("bin|pcd|ply");
  auto* ascii = sub->add_flag("--ascii", options->ascii, "Write numbers as text (pcd, ply)");
  sub->add_flag("--compressed", options->compressed, "Write binary_compressed (pcd)")
      ->excludes(ascii);
  sub->add_option("--layers", options->layers,
                  "Codec beam: decode this many layers only, coarsest first [all]")
      ->check(CLI::Range(1, DecoderOptions{}.max_layers).description(""))
      ->type_name("K");
  sub->add_flag("--fill", options->fill,
                "Codec beam: interpolate what a level or a byte budget left out; pcd and ply mark "
                "such points in a field \"filled\"");
  sub->add_flag("--json", options->json, "Print the outcome as JSON");
  sub->footer("Example: sweepcast decode drive.sweep -o decoded --format pcd");
  sub->callback([options, &command] {
    if (options->ascii && options->format == "bin") {
      throw CLI::ValidationError("--ascii", "goes with --format pcd or ply");
    }
    if (options->compressed && options->format != "pcd") {
      throw CLI::ValidationError("--compressed", "goes with --format pcd");
    }
    command = [options] { return decode(*options); };
  });
}

}  // namespace sweepcast::app
