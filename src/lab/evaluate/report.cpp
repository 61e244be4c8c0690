#include "lab/evaluate/report.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lab/evaluate/curve.hpp"
#include "lab/evaluate/report_sections.hpp"
#include "lab/evaluate/report_style.hpp"
#include "lab/evaluate/svg_plot.hpp"

namespace sweepcast::lab {
namespace {

std::string list_of(const std::vector<std::string>& items) {
  std::string text = "<ul>";
  for (const std::string& item : items) text += "<li>" + escaped(item) + "</li>";
  return text + "</ul>\n";
}

std::string head(const ReportText& text) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
      "style-src 'unsafe-inline'\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n"
      "<title>{0}: codecs by task</title>\n<style>{1}</style></head>\n<body>\n"
      "<header><h1>{0}: what codecs do to its tasks</h1>\n"
      "<p class=\"soft\">{2} sweeps; sweepcast {3}</p></header>\n",
      escaped(text.drive), kReportStyle, text.sweeps, escaped(text.version));
}

std::string notes(const ReportText& text) {
  std::string section = "<section><h2>How it was measured</h2>\n";
  section +=
      "<p>Ratio: 16 bytes for each point that came in (x, y, z, intensity as float32) over all "
      "bytes of the frames, the sensor's model among them. Every codec codes geometry alone. "
      "Times are CPU time of one thread, once a sweep. Where sweeps have times, every codec's "
      "points get theirs from their azimuth.</p>\n";
  section += list_of(text.tasks);
  if (!text.left_out.empty()) section += "<h3>Left out</h3>\n" + list_of(text.left_out);
  return section + "</section>\n";
}

}  // namespace

std::string report_page(std::span<const EvaluationRow> rows, const ReportText& text) {
  const CodecStyles styles(rows);
  return head(text) + standing_section(rows) + figure_section(rows, styles) +
         picture_section(rows) + time_section(rows) + part_section(rows) + notes(text) +
         table_section(rows) + "</body></html>\n";
}

}  // namespace sweepcast::lab
