#include "lab/stream/plot_stream.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>

namespace sweepcast::lab {
namespace {

/// The figures of one second, mean over its sweeps.
struct Second {
  double sweeps = 0, quality = 0, queued = 0, qoe = 0;
};

std::vector<Second> seconds_of(const Stream& stream) {
  std::vector<Second> seconds(static_cast<std::size_t>(stream.fates.back().ready_us / 1'000'000) +
                              1);
  for (std::size_t i = 0; i < stream.fates.size(); ++i) {
    Second& second = seconds[static_cast<std::size_t>(stream.fates[i].ready_us / 1'000'000)];
    const double quality = stream.qoe[i].quality;
    const auto queued = static_cast<double>(stream.qoe[i].queued);
    const double change = i > 0 ? std::abs(quality - stream.qoe[i - 1].quality) : 0.0;
    second.sweeps += 1;
    second.quality += quality;
    second.queued += queued;
    second.qoe += quality - kQueueWeight * queued - change;
  }
  return seconds;
}

std::string data_block(const Stream& stream, std::size_t id) {
  std::string block = fmt::format("$data{} << END\n", id);
  const auto seconds = seconds_of(stream);
  for (std::size_t t = 0; t < seconds.size(); ++t) {
    const Second& s = seconds[t];
    if (s.sweeps == 0) continue;
    block += fmt::format("{} {} {} {}\n", t, s.quality / s.sweeps, s.queued / s.sweeps,
                         s.qoe / s.sweeps);
  }
  return block + "END\n";
}

/// A panel with a curve a strategy: which column it shows.
struct Panel {
  const char* title;
  int column;
  const char* settings;
};

constexpr std::array<Panel, 3> kPanels{{
    {"quality q (25: level 0, 0: level 5)", 2, "set yrange [-1:26]"},
    {"frames in the queue, and one", 3, "set logscale y\nset yrange [0.9:*]"},
    {"QoE of a sweep", 4, "unset logscale y\nset yrange [-30:26]\nset xlabel \"seconds\""},
}};

}  // namespace

std::string stream_script(std::span<const Stream> streams, const Trace& trace,
                          const std::filesystem::path& output) {
  std::string script = plot_output(output, 1000, 1100);
  script += "set multiplot layout 4,1\nset grid\nset key outside right top\nset lmargin 9\n";
  std::size_t length = 0;
  for (std::size_t i = 0; i < streams.size(); ++i) {
    script += data_block(streams[i], i);
    length = static_cast<std::size_t>(streams[i].fates.back().ready_us / 1'000'000);
  }
  script += "$offered << END\n";
  const auto offered = bytes_per_second(trace, length);
  for (std::size_t t = 0; t < length; ++t) {
    script += fmt::format("{} {}\n", t, static_cast<double>(offered[t]) * 1e-3);
  }
  script += fmt::format(
      "END\nset xrange [0:{}]\nset title \"bandwidth of {}, kB/s\" noenhanced\n"
      "plot $offered using 1:2 with steps linecolor black title \"offered\"\n",
      length, trace.name);
  for (const Panel& panel : kPanels) {
    script += fmt::format("set title {}\n{}\n", gnuplot_string(panel.title), panel.settings);
    for (std::size_t i = 0; i < streams.size(); ++i) {
      script += fmt::format("{} $data{} using 1:{} with lines linestyle {} title {} noenhanced",
                            i == 0 ? "plot" : ",", i,
                            panel.column == 3 ? "($3+1)" : fmt::format("{}", panel.column), i + 1,
                            gnuplot_string(streams[i].summary.strategy));
    }
    script += '\n';
  }
  return script + "unset multiplot\n";
}

Status plot_streams(std::span<const Stream> streams, const Trace& trace,
                    const std::filesystem::path& output) {
  if (streams.empty()) return fail(ErrorCode::invalid_argument, "no stream to draw");
  return draw_plot(stream_script(streams, trace, output), output);
}

}  // namespace sweepcast::lab
