// The report's pictures and tables.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "lab/evaluate/curve.hpp"
#include "lab/evaluate/report_sections.hpp"
#include "lab/evaluate/svg_plot.hpp"
#include "lab/evaluate/sweep_picture.hpp"

namespace sweepcast::lab {
namespace {

constexpr double kShownRatio = 100.0;
constexpr std::size_t kMostPictures = 12;  ///< of about 150 kB each

/// Of each codec the setting nearest to the ratio that is shown; the uncoded drive first.
std::vector<const EvaluationRow*> shown_rows(std::span<const EvaluationRow> rows) {
  const auto distance = [](const EvaluationRow& row) {
    return std::abs(std::log(std::max(row.coding.ratio, 1e-9) / kShownRatio));
  };
  std::vector<const EvaluationRow*> shown;
  for (const EvaluationRow& row : rows) {
    const auto same = std::find_if(shown.begin(), shown.end(), [&](const EvaluationRow* other) {
      return other->codec == row.codec;
    });
    if (same == shown.end()) {
      shown.push_back(&row);
    } else if (distance(row) < distance(**same)) {
      *same = &row;
    }
  }
  return shown;
}

std::string caption_of(const EvaluationRow& row) {
  if (row.codec == kOriginal) return "<b>original</b>";
  return fmt::format("<b>{}</b>, {}<br>ratio {:.0f}", escaped(row.codec), escaped(row.setting),
                     row.coding.ratio);
}

/// "1.23" or "123", or a dash for what is no number.
std::string short_number(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "&ndash;";
}

std::string bar_of(const EvaluationRow& row, const std::vector<std::string>& names) {
  double sum = 0.0;
  for (const auto& [part, bytes] : row.coding.parts) sum += bytes;
  if (!(sum > 0.0)) return {};
  std::string spans, words;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto part = row.coding.parts.find(names[i]);
    if (part == row.coding.parts.end() || part->second <= 0.0) continue;
    const double percent = 100.0 * part->second / sum;
    const std::string title =
        fmt::format("{}: {:.0f} bytes, {:.1f} %", escaped(names[i]), part->second, percent);
    spans += fmt::format("<span class=\"s{}\" style=\"width:{:.2f}%\" title=\"{}\"></span>", i % 10,
                         percent, title);
    words += fmt::format("{}{} {:.0f} %", words.empty() ? "" : ", ", escaped(names[i]), percent);
  }
  return fmt::format(
      "<div class=\"bar-row\"><div><b>{}</b>, {}: {:.0f} bytes a sweep, ratio {:.0f}</div>"
      "<div class=\"bar\" role=\"img\" aria-label=\"{}\">{}</div></div>\n",
      escaped(row.codec), escaped(row.setting), row.coding.bytes, row.coding.ratio, words, spans);
}

/// The bars of one codec, with the names of the parts.
std::string bars_of(std::span<const EvaluationRow> rows, std::string_view codec) {
  std::set<std::string> all;
  for (const EvaluationRow& row : rows) {
    if (row.codec != codec) continue;
    for (const auto& [part, bytes] : row.coding.parts) {
      if (bytes > 0.0) all.insert(part);
    }
  }
  const std::vector<std::string> names(all.begin(), all.end());
  std::string bars, legend;
  for (const EvaluationRow& row : rows) {
    if (row.codec == codec) bars += bar_of(row, names);
  }
  if (bars.empty()) return {};
  for (std::size_t i = 0; i < names.size(); ++i) {
    legend +=
        fmt::format("<li><span class=\"swatch s{}\"></span>{}</li>", i % 10, escaped(names[i]));
  }
  return fmt::format("<figure>{}<ul class=\"legend\">{}</ul></figure>\n", bars, legend);
}

}  // namespace

std::string picture_section(std::span<const EvaluationRow> rows) {
  std::string figures;
  std::size_t count = 0;
  for (const EvaluationRow* row : shown_rows(rows)) {
    if (row->coding.picture.empty() || ++count > kMostPictures) continue;
    figures += fmt::format(
        "<figure><img width=\"{0}\" height=\"{0}\" alt=\"{1}: the sweep from above\" "
        "src=\"data:image/png;base64,{2}\"><figcaption>{3}</figcaption></figure>\n",
        kPicturePixels, escaped(row->codec), escaped(row->coding.picture), caption_of(*row));
  }
  if (figures.empty()) return {};
  return fmt::format(
      "<section><h2>A sweep, before and after</h2>\n<p>The drive's middle sweep from above, "
      "{:.0f} m to each side, coloured by height; of each codec the setting nearest to a ratio of "
      "{:.0f}.</p>\n<div class=\"pictures\">\n{}</div></section>\n",
      kPictureReachM, kShownRatio, figures);
}

std::string time_section(std::span<const EvaluationRow> rows) {
  std::string body;
  for (const EvaluationRow* row : shown_rows(rows)) {
    if (row->codec == kOriginal) continue;
    body += fmt::format(
        "<tr><td>{}</td><td class=\"name\">{}</td><td>{:.1f}</td><td>{:.1f}</td><td>{:.1f}</td>"
        "</tr>\n",
        escaped(row->codec), escaped(row->setting), row->coding.ratio, row->coding.encode_ms,
        row->coding.decode_ms);
  }
  if (body.empty()) return {};
  return fmt::format(
      "<section><h2>Time</h2>\n<p>Milliseconds of CPU time a sweep, of each codec at the setting "
      "nearest to a ratio of {:.0f}. Where beam aims at a size it encodes a sweep several times "
      "over; at a level it encodes once.</p>\n<div class=\"wide\"><table><thead><tr><th>Codec</th>"
      "<th class=\"name\">Setting</th><th>Ratio</th><th>Encode, ms</th><th>Decode, ms</th></tr>"
      "</thead><tbody>\n{}</tbody></table></div></section>\n",
      kShownRatio, body);
}

std::string part_section(std::span<const EvaluationRow> rows) {
  const std::string figures = bars_of(rows, "beam") + bars_of(rows, "rcpcc");
  if (figures.empty()) return {};
  return "<section><h2>Where the bytes go</h2>\n<p>Parts of our frames, mean over the "
         "sweeps.</p>\n<div class=\"grid\">\n" +
         figures + "</div></section>\n";
}

std::string table_section(std::span<const EvaluationRow> rows) {
  const std::vector<const Metric*> metrics = metrics_of(rows);
  std::string head;
  for (const Metric* metric : metrics) {
    head += fmt::format("<th>{}, {}</th>", metric->figure, metric->unit);
  }
  std::string body;
  for (const EvaluationRow& row : rows) {
    body +=
        fmt::format("<tr><td>{}</td><td class=\"name\">{}</td><td>{:.1f}</td><td>{:.0f}</td>",
                    escaped(row.codec), escaped(row.setting), row.coding.ratio, row.coding.bytes);
    body +=
        fmt::format("<td>{:.1f}</td><td>{:.1f}</td>", row.coding.encode_ms, row.coding.decode_ms);
    for (const Metric* metric : metrics) {
      body += "<td>" + short_number(row.figure(metric->figure), metric->digits) + "</td>";
    }
    body += "</tr>\n";
  }
  return fmt::format(
      "<section><h2>All figures</h2>\n<p class=\"soft\">The same numbers, and more, are in "
      "results.json and results.csv beside this page.</p>\n<div class=\"wide\"><table><thead><tr>"
      "<th>Codec</th><th class=\"name\">Setting</th><th>Ratio</th><th>Bytes</th><th>Enc., ms</th>"
      "<th>Dec., ms</th>{}</tr></thead><tbody>\n{}</tbody></table></div></section>\n",
      head, body);
}

}  // namespace sweepcast::lab
