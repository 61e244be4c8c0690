#include "lab/plot.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace sweepcast::lab {
namespace {

/// The rows of one codec, ascending by ratio.
struct Curve {
  std::string codec;
  std::vector<const BenchRow*> rows;
};

std::vector<Curve> curves_of(std::span<const BenchRow> rows) {
  std::vector<Curve> curves;
  for (const BenchRow& row : rows) {
    // What the decoder fills in is a curve of its own.
    const std::string name = row.codec + (row.setting.ends_with(" fill") ? ", filled" : "");
    auto curve = std::find_if(curves.begin(), curves.end(),
                              [&name](const Curve& c) { return c.codec == name; });
    if (curve == curves.end()) curve = curves.insert(curve, {name, {}});
    curve->rows.push_back(&row);
  }
  for (Curve& curve : curves) {
    std::stable_sort(curve.rows.begin(), curve.rows.end(),
                     [](const BenchRow* a, const BenchRow* b) { return a->ratio < b->ratio; });
  }
  return curves;
}

/// One panel: what its vertical axis shows.
struct Panel {
  const char* title;
  double (*value)(const BenchRow&);
  const char* range;
};

constexpr std::array<Panel, 3> kPanels{{
    {"D2 PSNR, dB", [](const BenchRow& row) { return row.distortion.d2_psnr; }, "[*:*]"},
    {"F-score at 5 cm, %", [](const BenchRow& row) { return row.distortion.f_score[1]; },
     "[0:107]"},
    {"F-score at 10 cm, %", [](const BenchRow& row) { return row.distortion.f_score[2]; },
     "[0:107]"},
}};

/// The first word of a setting; the rest, as in "qp11 cl7", is the same along a curve.
std::string label_of(const BenchRow& row) {
  return row.setting.substr(0, row.setting.find(' '));
}

/// A named data block with a line "ratio value setting" for every row that has both numbers.
std::string data_block(const Curve& curve, const Panel& panel, std::size_t id) {
  std::string block = fmt::format("$data{} << END\n", id);
  for (const BenchRow* row : curve.rows) {
    const double value = panel.value(*row);
    if (row->ratio > 0 && std::isfinite(value)) {
      block += fmt::format("{} {} {}\n", row->ratio, value, gnuplot_string(label_of(*row)));
    }
  }
  return block + "END\n";
}

std::string panel_script(std::span<const Curve> curves, const Panel& panel) {
  std::string blocks;
  std::string plots;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    blocks += data_block(curves[i], panel, i);
    // Curves fall to the right: the labels of every other one go above it, the rest below.
    const char* place = i % 2 == 0 ? "left offset 0.6,0.5" : "right offset -0.6,-0.5";
    plots += fmt::format(
        "{0} $data{1} using 1:2 with linespoints linestyle {2} title {3}, "
        "$data{1} using 1:2:3 with labels {4} font ',9' textcolor linestyle {2} notitle",
        i == 0 ? "plot" : ", ", i, i % 6 + 1, gnuplot_string(curves[i].codec), place);
  }
  return fmt::format("{}set title {}\nset yrange {}\n{}\n", blocks, gnuplot_string(panel.title),
                     panel.range, plots);
}

constexpr const char* kStyle = R"gnuplot(set encoding utf8
set multiplot layout 1,3 margins 0.04,0.985,0.11,0.92 spacing 0.05,0
set logscale x 2
set xlabel "ratio (16 bytes a point / bytes)"
set xtics (5, 10, 20, 50, 100, 200, 500, 1000, 2000)
set offsets graph 0.06, graph 0.12, graph 0.06, graph 0.06
set grid linecolor rgb "#dddddd" linetype 1
set border 3 linecolor rgb "#555555"
set tics nomirror out scale 0.6
set key bottom left Left reverse samplen 1.5 opaque
set style line 1 linewidth 2 pointtype 7 pointsize 0.9 linecolor rgb "#0b62a4"
set style line 2 linewidth 2 pointtype 5 pointsize 0.9 linecolor rgb "#c8501e"
set style line 3 linewidth 2 pointtype 9 pointsize 0.9 linecolor rgb "#2a8a4a"
set style line 4 linewidth 2 pointtype 11 pointsize 0.9 linecolor rgb "#7a4ba0"
set style line 5 linewidth 2 pointtype 13 pointsize 0.9 linecolor rgb "#b08a00"
set style line 6 linewidth 2 pointtype 4 pointsize 0.9 linecolor rgb "#444444"
)gnuplot";

}  // namespace

std::string rate_distortion_script(std::span<const BenchRow> rows,
                                   const std::filesystem::path& output) {
  const std::vector<Curve> curves = curves_of(rows);
  std::string script = plot_output(output, 1650, 600) + kStyle;
  for (const Panel& panel : kPanels) script += panel_script(curves, panel);
  return script + "unset multiplot\n";
}

Status plot_rate_distortion(std::span<const BenchRow> rows, const std::filesystem::path& output) {
  if (rows.empty()) {
    return fail(ErrorCode::invalid_argument, output.string() + ": nothing to plot");
  }
  return draw_plot(rate_distortion_script(rows, output), output);
}

}  // namespace sweepcast::lab
