// Line plots as SVG inside a page, whose style sheet gives the colours: strokes and fills of class
// `s0`, `s1` and so on are those of the series, `axis`, `rule` and `base` the rest.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sweepcast::lab {

/// Text as HTML and SVG show it; also safe between quotes of an attribute. Bytes that are not UTF-8
/// or are control characters become U+FFFD.
[[nodiscard]] std::string escaped(std::string_view text);

struct PlotPoint {
  double x = 0.0, y = 0.0;
  std::string note;  ///< shown where the pointer rests on it
};

struct PlotSeries {
  std::size_t style = 0;  ///< number of its colour and marker
  bool strong = false;    ///< drawn last, and thicker
  std::vector<PlotPoint> points;
};

struct Plot {
  std::string title;  ///< for those who cannot see it
  std::string x_label, y_label;
  double x_min = 1.0, x_max = 10.0;  ///< logarithmic
  std::vector<double> x_ticks;
  double y_min = 0.0, y_max = 1.0;  ///< linear; lines beyond are cut there
  std::optional<double> base;       ///< a dashed line across
  std::vector<PlotSeries> series;
};

/// The picture, as wide as what it stands in.
[[nodiscard]] std::string svg_of(const Plot& plot);

/// A marker of a style alone, for a legend.
[[nodiscard]] std::string svg_marker(std::size_t style);

/// Round numbers from `low` to `high`, about five.
[[nodiscard]] std::vector<double> round_ticks(double low, double high);

}  // namespace sweepcast::lab
