// The report's figures, and who is ahead in them.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "lab/evaluate/curve.hpp"
#include "lab/evaluate/report_sections.hpp"
#include "lab/evaluate/svg_plot.hpp"

namespace sweepcast::lab {
namespace {

constexpr std::size_t kStyles = 10;  ///< that the style sheet has

std::string number(double value, const Metric& metric) {
  return fmt::format("{:.{}f}", value, metric.digits);
}

/// The uncoded drive's figure; NaN where there is none.
double uncoded(std::span<const EvaluationRow> rows, const Metric& metric) {
  const auto row = std::find_if(rows.begin(), rows.end(),
                                [](const EvaluationRow& r) { return r.codec == kOriginal; });
  return row == rows.end() ? std::nan("") : row->figure(metric.figure);
}

/// Lowest and highest value that the figure shows. One bad codec shall not flatten the others.
void set_y_range(const std::vector<Curve>& curves, double base, const Metric& metric, Plot& plot) {
  double low = std::isfinite(base) ? base : curves.front().points.front().value, high = low;
  for (const Curve& curve : curves) {
    for (const CurvePoint& point : curve.points) {
      low = std::min(low, point.value);
      high = std::max(high, point.value);
    }
  }
  if (!metric.higher_is_better) {
    high = std::min(high, 4.0 * (std::isfinite(base) && base > 0.0 ? base : low));
    low = 0.0;
  }
  if (metric.higher_is_better && metric.unit == "%") high = 100.0;
  const auto ticks = round_ticks(low, high);
  const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : std::max(1e-6, 0.1 * high);
  plot.y_min = step * std::floor(low / step + 1e-9);
  plot.y_max = std::max(step * std::ceil(high / step - 1e-9), plot.y_min + step);
}

void set_x_range(const std::vector<Curve>& curves, Plot& plot) {
  double low = 10.0, high = 400.0;
  for (const Curve& curve : curves) {
    low = std::min(low, curve.points.front().ratio);
    high = std::max(high, curve.points.back().ratio);
  }
  plot.x_min = std::max(low, 5.0);
  plot.x_max = std::min(high, 600.0);
  for (const double tick : {5.0, 10.0, 20.0, 30.0, 60.0, 100.0, 200.0, 400.0}) {
    if (tick >= plot.x_min && tick <= plot.x_max) plot.x_ticks.push_back(tick);
  }
}

/// Points a little beyond the figure's sides are cut off with their lines.
PlotSeries series_of(const Curve& curve, const Metric& metric, std::size_t style) {
  PlotSeries series{style, style == 0, {}};
  for (const CurvePoint& point : curve.points) {
    series.points.push_back({point.ratio, point.value,
                             fmt::format("{} {}: {} {} at ratio {:.1f}", curve.codec, point.setting,
                                         number(point.value, metric), metric.unit, point.ratio)});
  }
  return series;
}

std::string figure_of(std::span<const EvaluationRow> rows, const Metric& metric,
                      const CodecStyles& styles) {
  const std::vector<Curve> curves = curves_of(rows, metric.figure);
  if (curves.empty()) return {};
  const double base = uncoded(rows, metric);
  Plot plot;
  plot.title = fmt::format("{} over the ratio, a line for each codec", metric.title);
  plot.x_label = "ratio (logarithmic)";
  plot.y_label = std::string(metric.unit);
  set_x_range(curves, plot);
  set_y_range(curves, base, metric, plot);
  if (std::isfinite(base)) plot.base = base;
  std::string legend;
  for (const Curve& curve : curves) {
    const std::size_t style = styles.of(curve.codec);
    plot.series.push_back(series_of(curve, metric, style));
    legend += fmt::format("<li>{}{}</li>", svg_marker(style), escaped(curve.codec));
  }
  std::string caption = metric.higher_is_better ? "Higher is better." : "Lower is better.";
  if (plot.base) caption += fmt::format(" Dashed: the uncoded drive, {}.", number(base, metric));
  const bool is_cut = std::any_of(curves.begin(), curves.end(), [&](const Curve& curve) {
    return std::any_of(curve.points.begin(), curve.points.end(),
                       [&](const CurvePoint& point) { return point.value > plot.y_max; });
  });
  if (is_cut) caption += " Lines that leave the figure go on above it.";
  return fmt::format(
      "<figure><h3>{}, {}</h3>\n{}<ul class=\"legend\">{}</ul>\n<figcaption>{}</figcaption>"
      "</figure>\n",
      escaped(metric.title), escaped(metric.unit), svg_of(plot), legend, caption);
}

std::string cell_of(const Standing& standing) {
  const Metric& metric = *standing.metric;
  if (standing.rival.empty()) {
    return fmt::format("<td class=\"ahead\">&#10003; {}<small>no other so small</small></td>",
                       number(standing.ours, metric));
  }
  return fmt::format("<td class=\"{}\">{} {}<small>{} {}</small></td>",
                     standing.is_ahead() ? "ahead" : "behind",
                     standing.is_ahead() ? "&#10003;" : "&#10007;", number(standing.ours, metric),
                     escaped(standing.rival), number(standing.theirs, metric));
}

std::string row_of(const std::vector<Standing>& standings, const Metric& metric) {
  std::string cells;
  for (const double ratio : kRatios) {
    const auto at = std::find_if(standings.begin(), standings.end(), [&](const Standing& s) {
      return s.metric == &metric && s.ratio == ratio;
    });
    cells += at == standings.end() ? "<td>&ndash;</td>" : cell_of(*at);
  }
  return fmt::format("<tr><td>{}, {}</td>{}</tr>\n", escaped(metric.title), escaped(metric.unit),
                     cells);
}

/// Where beam is not ahead, in a sentence each.
std::string exceptions_of(const std::vector<Standing>& standings) {
  std::string items;
  for (const Standing& standing : standings) {
    if (standing.is_ahead()) continue;
    const Metric& metric = *standing.metric;
    items += fmt::format("<li>{}, ratio {}: beam {}, {} {} ({:+.{}f})</li>", escaped(metric.title),
                         standing.ratio, number(standing.ours, metric), escaped(standing.rival),
                         number(standing.theirs, metric), standing.ours - standing.theirs,
                         metric.digits);
  }
  return items.empty() ? items : "<p>It is not ahead here:</p><ul>" + items + "</ul>\n";
}

}  // namespace

CodecStyles::CodecStyles(std::span<const EvaluationRow> rows) : codecs_{"beam"} {
  for (const EvaluationRow& row : rows) {
    if (row.codec == kOriginal) continue;
    if (std::find(codecs_.begin(), codecs_.end(), row.codec) == codecs_.end()) {
      codecs_.push_back(row.codec);
    }
  }
}

std::size_t CodecStyles::of(const std::string& codec) const {
  const auto at = std::find(codecs_.begin(), codecs_.end(), codec);
  return static_cast<std::size_t>(at - codecs_.begin()) % kStyles;
}

std::string standing_section(std::span<const EvaluationRow> rows) {
  const std::vector<Standing> standings = standings_of(rows);
  if (standings.empty()) return {};
  const auto ahead = std::count_if(standings.begin(), standings.end(),
                                   [](const Standing& s) { return s.is_ahead(); });
  std::string head;
  for (const double ratio : kRatios) head += fmt::format("<th>{}</th>", ratio);
  std::string body;
  for (const Metric* metric : metrics_of(rows)) body += row_of(standings, *metric);
  return fmt::format(
      "<section><h2>Who is ahead</h2>\n<p>Codec <b>beam</b> is ahead of every other codec, or "
      "level with the best, in {} of "
      "{} places. Below its figure stands the best of the others: what they give at that ratio or "
      "a larger one, between their settings by the line over the ratio's logarithm.</p>\n{}"
      "<p class=\"soft scroll-hint\">The table can be moved sideways.</p>\n"
      "<div class=\"wide\"><table class=\"standing\"><thead><tr><th>At "
      "ratio</th>{}</tr></thead><tbody>\n{}</tbody>"
      "</table></div></section>\n",
      ahead, standings.size(), exceptions_of(standings), head, body);
}

std::string figure_section(std::span<const EvaluationRow> rows, const CodecStyles& styles) {
  std::string figures;
  for (const Metric* metric : metrics_of(rows)) figures += figure_of(rows, *metric, styles);
  if (figures.empty()) return {};
  return "<section><h2>Tasks over the ratio</h2>\n<div class=\"grid\">\n" + figures +
         "</div></section>\n";
}

}  // namespace sweepcast::lab
