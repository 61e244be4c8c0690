// `sweepcast info`: what is in a .sweep file, without decoding it.
#include <fmt/core.h>

#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "codec/frame_edit.hpp"
#include "common/counts.hpp"
#include "common/recording.hpp"
#include "sweepcast/commands.hpp"
#include "sweepcast/frame.hpp"
#include "sweepcast/sweep_file.hpp"

namespace sweepcast::app {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct InfoOptions {
  fs::path input;
  bool frames = false;
  bool json = false;
};

/// Sums over the frames of a file.
struct Summary {
  std::size_t frames = 0;
  CountSums counts;
  LayerSums layers;
  std::uint64_t frame_bytes = 0;
  std::map<std::string, std::uint64_t> part_bytes;  ///< "header" and each part's name
  std::map<std::string, std::size_t> codecs;        ///< frames of each
  std::map<std::string, std::size_t> sensors;       ///< frames of each
};

std::map<std::string, std::uint64_t> bytes_by_part(const FrameHeader& header) {
  std::map<std::string, std::uint64_t> bytes{{"header", header.header_size}};
  for (const FramePart& part : header.parts) {
    bytes[std::string(part_name(header.codec, part.kind))] += part.size;
  }
  return bytes;
}

void add(Summary& summary, const FrameHeader& header, const LayerCounts& layers) {
  ++summary.frames;
  summary.counts.add(header.counts);
  summary.layers.add(layers);
  summary.frame_bytes += header.frame_size;
  for (const auto& [part, bytes] : bytes_by_part(header)) summary.part_bytes[part] += bytes;
  ++summary.codecs[std::string(name(header.codec))];
  ++summary.sensors[header.sensor];
}

ordered_json frame_json(const SweepEntry& entry, const FrameHeader& header,
                        const LayerCounts& layers) {
  return {{"name", entry.name},
          {"sequence", header.sequence},
          {"stamp_ns", header.stamp_ns},
          {"sensor", header.sensor},
          {"codec", name(header.codec)},
          {"version", header.version},
          {"offset", entry.offset},
          {"bytes", header.frame_size},
          {"layers", layers.there},
          {"layers_missing", layers.missing()},
          {"parts", bytes_by_part(header)},
          {"counts", sums_of(header.counts).json()}};
}

/// The keys of a map, separated by commas; "(none)" for an empty key.
std::string list(const std::map<std::string, std::size_t>& names) {
  std::string text;
  for (const auto& [key, count] : names) {
    text += (text.empty() ? "" : ", ") + (key.empty() ? "(none)" : printable(key));
  }
  return text;
}

void report_text(const InfoOptions& options, const SweepReader& reader, const Summary& summary) {
  fmt::print("{}: {}, {} bytes{}\n", options.input.string(),
             count_of(reader.entries().size(), "frame"), reader.file_size(),
             reader.was_cut() ? "; no index, found by walking the frames" : "");
  if (summary.frames == 0) return;
  const auto count = static_cast<double>(summary.frames);
  fmt::print("  codec {}, sensor {}\n", list(summary.codecs), list(summary.sensors));
  fmt::print("  {} points in, {} coded; not coded: {}\n", summary.counts.points_in(),
             summary.counts.points_coded(), summary.counts.losses());
  if (const std::string text = summary.layers.text(); !text.empty()) fmt::print("  {}\n", text);
  const bool attributes = summary.part_bytes.count("attributes") > 0;
  fmt::print("  {:.0f} bytes a frame; ratio {:.1f} (16 B/point, geometry {})\n",
             static_cast<double>(summary.frame_bytes) / count,
             ratio(summary.counts.points_in(), summary.frame_bytes),
             attributes ? "and attributes" : "only");
  for (const auto& [part, bytes] : summary.part_bytes) {
    fmt::print("  {:<12} {:>10} bytes  {:5.1f} %\n", part, bytes,
               100.0 * static_cast<double>(bytes) / static_cast<double>(summary.frame_bytes));
  }
}

void print_frame(const SweepEntry& entry, const FrameHeader& header, const LayerCounts& layers) {
  fmt::print("{:>8} {:>20} {:>9} {:>9} {:>9} {:>6}  {}\n", header.sequence, header.stamp_ns,
             header.counts.points_in, header.counts.points_coded, header.frame_size,
             fmt::format("{}/{}", layers.there, layers.made), printable(entry.name));
}

Status info(const InfoOptions& options) {
  auto reader = SweepReader::open(options.input);
  if (!reader) return tl::unexpected(reader.error());
  Summary summary;
  ordered_json frames = ordered_json::array();
  std::size_t damaged = 0;
  std::vector<std::byte> bytes;
  FrameHeader header;
  if (options.frames && !options.json) {
    fmt::print("{:>8} {:>20} {:>9} {:>9} {:>9} {:>6}  {}\n", "sequence", "stamp_ns", "in", "coded",
               "bytes", "layers", "name");
  }
  for (std::size_t i = 0; i < reader->entries().size(); ++i) {
    const SweepEntry& entry = reader->entries()[i];
    Status read = reader->read(i, bytes);
    if (read) read = parse_frame_header(bytes, header);
    Result<LayerCounts> layers;
    if (read) layers = count_layers(bytes, header);
    if (!layers) read = tl::unexpected(layers.error());
    if (!read) {
      print_error(frame_error(options.input, *reader, i, read.error().message));
      ++damaged;
      continue;
    }
    add(summary, header, *layers);
    if (options.json) {
      frames.push_back(frame_json(entry, header, *layers));
    } else if (options.frames) {
      print_frame(entry, header, *layers);
    }
  }
  if (options.json) {
    print_json({{"file", options.input.string()},
                {"file_bytes", reader->file_size()},
                {"index_rebuilt", reader->was_cut()},
                {"frame_bytes", summary.frame_bytes},
                {"parts", summary.part_bytes},
                {"counts", summary.counts.json()},
                {"frames_cut", summary.layers.frames_cut},
                {"layers_missing", summary.layers.missing},
                {"damaged", damaged},
                {"frames", frames}});
  } else {
    report_text(options, *reader, summary);
  }
  if (damaged == 0) return check_complete(options.input, *reader);
  return fail(ErrorCode::corrupt, fmt::format("{}: {} damaged; encode or fetch again",
                                              options.input.string(), count_of(damaged, "frame")));
}

}  // namespace

void add_info(CLI::App& app, Command& command) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* sub = app.add_subcommand("info", "Tell what is in a .sweep file");
  sub->add_option("FILE", options->input, "The .sweep file")->type_name("FILE.sweep")->required();
  sub->add_flag("--frames", options->frames, "One line a frame, too");
  sub->add_flag("--json", options->json, "Print everything as JSON, with every frame");
  sub->footer("Example: sweepcast info drive.sweep --frames");
  sub->callback([options, &command] { command = [options] { return info(*options); }; });
}

}  // namespace sweepcast::app
