// The report: one page for people, that needs nothing beside itself.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "lab/evaluate/evaluate.hpp"

namespace sweepcast::lab {

/// What the page tells beside the results. Text may come from anywhere; the page shows it as it is.
struct ReportText {
  std::string drive;  ///< its name
  std::size_t sweeps = 0;
  std::string version;
  std::vector<std::string> tasks;     ///< what each task took, a sentence each
  std::vector<std::string> left_out;  ///< tasks, codecs and settings that are missing, and why
};

/// An HTML page with its style, figures and pictures inside: no requests, no scripts. The same
/// results and text give the same page.
[[nodiscard]] std::string report_page(std::span<const EvaluationRow> rows, const ReportText& text);

}  // namespace sweepcast::lab
