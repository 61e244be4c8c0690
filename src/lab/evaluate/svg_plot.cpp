#include "lab/evaluate/svg_plot.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace sweepcast::lab {
namespace {

// The picture's own units; text of 13 stays legible where a phone makes 480 of them 340 pixels.
constexpr double kWidth = 480.0, kHeight = 330.0;
constexpr double kLeft = 52.0, kRight = 466.0, kTop = 14.0, kBottom = 282.0;

/// Bytes of the UTF-8 character at the begin; 0 where there is none. After RFC 3629.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<std::uint8_t>(text[i]) : 0U;
  };
  const auto goes_on = [&](std::size_t i) { return (byte(i) & 0xC0U) == 0x80U; };
  const std::uint32_t first = byte(0), second = byte(1);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF && goes_on(1)) return 2;
  if (first >= 0xE0 && first <= 0xEF && goes_on(1) && goes_on(2)) {
    const bool is_short = first == 0xE0 && second < 0xA0;
    const bool is_surrogate = first == 0xED && second > 0x9F;
    return is_short || is_surrogate ? 0 : 3;
  }
  if (first >= 0xF0 && first <= 0xF4 && goes_on(1) && goes_on(2) && goes_on(3)) {
    const bool is_short = first == 0xF0 && second < 0x90;
    const bool is_beyond = first == 0xF4 && second > 0x8F;
    return is_short || is_beyond ? 0 : 4;
  }
  return 0;
}

/// Where values lie in the picture.
struct Frame {
  explicit Frame(const Plot& plot_) : plot(plot_) {}

  [[nodiscard]] double x(double value) const {
    const double share = std::log(value / plot.x_min) / std::log(plot.x_max / plot.x_min);
    return kLeft + (kRight - kLeft) * share;
  }
  [[nodiscard]] double y(double value) const {
    return kBottom - (kBottom - kTop) * (value - plot.y_min) / (plot.y_max - plot.y_min);
  }
  /// Not so far out that numbers become unwieldy.
  [[nodiscard]] double y_cut(double value) const {
    return std::clamp(y(value), kTop - 2000.0, kBottom + 2000.0);
  }

  const Plot& plot;
};

std::string marker(std::size_t style, double x, double y) {
  constexpr double kSize = 4.2;
  const double a = kSize, b = 1.25 * kSize;
  switch (style % 5) {
    case 0:
      return fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="{}"/>)", x, y, a);
    case 1:
      return fmt::format(R"(<path d="M{:.1f} {:.1f}h{}v{}h-{}z"/>)", x - a, y - a, 2 * a, 2 * a,
                         2 * a);
    case 2:
      return fmt::format(R"(<path d="M{:.1f} {:.1f}l{} {}h-{}z"/>)", x, y - b, b, 2 * a, 2 * b);
    case 3:
      return fmt::format(R"(<path d="M{:.1f} {:.1f}l{} {}l-{} {}l-{} -{}z"/>)", x, y - b, b, b, b,
                         b, b, b);
    default:
      return fmt::format(R"(<path d="M{:.1f} {:.1f}l{} -{}h-{}z"/>)", x, y + b, b, 2 * a, 2 * b);
  }
}

std::string axes(const Frame& frame) {
  const Plot& plot = frame.plot;
  std::string text;
  for (const double tick : round_ticks(plot.y_min, plot.y_max)) {
    const double y = frame.y(tick);
    text += fmt::format(R"(<path class="rule" d="M{} {:.1f}H{}"/>)", kLeft, y, kRight);
    text += fmt::format(R"(<text x="{}" y="{:.1f}" text-anchor="end">{:.6g}</text>)", kLeft - 7,
                        y + 4.5, tick);
  }
  for (const double tick : plot.x_ticks) {
    const double x = frame.x(tick);
    text += fmt::format(R"(<path class="rule" d="M{:.1f} {}V{}"/>)", x, kTop, kBottom);
    text += fmt::format(R"(<text x="{:.1f}" y="{}" text-anchor="middle">{:.6g}</text>)", x,
                        kBottom + 19, tick);
  }
  text += fmt::format(R"(<path class="axis" d="M{} {}V{}H{}"/>)", kLeft, kTop, kBottom, kRight);
  const double middle = (kTop + kBottom) / 2;
  text += fmt::format(R"(<text x="{}" y="{}" text-anchor="middle">{}</text>)", (kLeft + kRight) / 2,
                      kBottom + 40, escaped(plot.x_label));
  text += fmt::format(
      R"svg(<text x="14" y="{}" text-anchor="middle" transform="rotate(-90 14 {})">{}</text>)svg",
      middle, middle, escaped(plot.y_label));
  return text;
}

std::string drawn(const PlotSeries& series, const Frame& frame) {
  std::string line, marks;
  for (const PlotPoint& point : series.points) {
    const double x = frame.x(point.x), y = frame.y_cut(point.y);
    line += fmt::format("{}{:.1f} {:.1f}", line.empty() ? "M" : "L", x, y);
    marks +=
        fmt::format("<g>{}<title>{}</title></g>", marker(series.style, x, y), escaped(point.note));
  }
  return fmt::format(R"(<g class="s{}{}"><path class="line" d="{}"/>{}</g>)", series.style,
                     series.strong ? " strong" : "", line, marks);
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string safe;
  while (!text.empty()) {
    const char c = text.front();
    const std::size_t length = utf8_length(text);
    const bool is_control = static_cast<std::uint8_t>(c) < 0x20 || c == 0x7F;
    if (length == 0 || is_control) {
      safe += "\xEF\xBF\xBD";
    } else if (c == '&') {
      safe += "&amp;";
    } else if (c == '<') {
      safe += "&lt;";
    } else if (c == '>') {
      safe += "&gt;";
    } else if (c == '"') {
      safe += "&quot;";
    } else if (c == '\'') {
      safe += "&#39;";
    } else {
      safe += text.substr(0, length);
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return safe;
}

std::vector<double> round_ticks(double low, double high) {
  std::vector<double> ticks;
  if (!(high > low) || !std::isfinite(high - low)) return ticks;
  const double rough = (high - low) / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * power;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * power >= 0.999 * rough) step = factor * power;
  }
  const double begin = std::ceil(low / step - 1e-9), end = std::floor(high / step + 1e-9);
  for (double i = begin; i <= end; i += 1.0) ticks.push_back(i * step + 0.0);  // -0 is 0
  return ticks;
}

std::string svg_marker(std::size_t style) {
  return fmt::format(
      R"(<svg class="key s{}" viewBox="0 0 26 12" aria-hidden="true"><path class="line" d="M1 6H25"/>{}</svg>)",
      style, marker(style, 13.0, 6.0));
}

std::string svg_of(const Plot& plot) {
  const Frame frame(plot);
  std::string text =
      fmt::format(R"(<svg class="plot" viewBox="0 0 {} {}" role="img" aria-label="{}">)", kWidth,
                  kHeight, escaped(plot.title));
  text += axes(frame);
  constexpr double kRoom = 6.0;  // for markers on the rim
  text += fmt::format(R"(<svg x="{}" y="{}" width="{}" height="{}" viewBox="{} {} {} {}">)",
                      kLeft - kRoom, kTop - kRoom, kRight - kLeft + 2 * kRoom,
                      kBottom - kTop + 2 * kRoom, kLeft - kRoom, kTop - kRoom,
                      kRight - kLeft + 2 * kRoom, kBottom - kTop + 2 * kRoom);
  if (plot.base && *plot.base >= plot.y_min && *plot.base <= plot.y_max) {
    text += fmt::format(R"(<path class="base" d="M{} {:.1f}H{}"/>)", kLeft, frame.y(*plot.base),
                        kRight);
  }
  for (const bool strong : {false, true}) {
    for (const PlotSeries& series : plot.series) {
      if (series.strong == strong && !series.points.empty()) text += drawn(series, frame);
    }
  }
  return text + "</svg></svg>\n";
}

}  // namespace sweepcast::lab
