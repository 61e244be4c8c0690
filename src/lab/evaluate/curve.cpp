#include "lab/evaluate/curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace sweepcast::lab {
namespace {

constexpr std::string_view kStepError = "step_translation_m";
constexpr std::string_view kPathError = "translation_error_percent";

constexpr std::array<Metric, 9> kMetrics{{
    {kPathError, "odometry", "Odometry: translation error", "%", 3, false},
    {kStepError, "odometry", "Odometry: error from sweep to sweep", "m", 4, false},
    {"mesh_f10", "mesh", "Mesh: F-score at 10 cm against the uncoded sweeps' mesh", "%", 1, true},
    {"mesh_f10_truth", "mesh", "Mesh: F-score at 10 cm against the true surface", "%", 1, true},
    {"bev_ap70", "detection", "Detection: AP from above, overlap 0.7", "%", 1, true},
    {"bev_ap50", "detection", "Detection: AP from above, overlap 0.5", "%", 1, true},
    {"f_score.0.05", "distortion", "Distortion: F-score at 5 cm", "%", 1, true},
    {"f_score.0.10", "distortion", "Distortion: F-score at 10 cm", "%", 1, true},
    {"d2_psnr", "distortion", "Distortion: D2 PSNR", "dB", 1, true},
}};

bool is_better(double a, double b, bool higher_is_better) {
  return higher_is_better ? a > b : a < b;
}

}  // namespace

std::vector<const Metric*> metrics_of(std::span<const EvaluationRow> rows) {
  const auto has = [&](std::string_view figure) {
    return std::any_of(rows.begin(), rows.end(),
                       [&](const EvaluationRow& row) { return std::isfinite(row.figure(figure)); });
  };
  std::vector<const Metric*> metrics;
  for (const Metric& metric : kMetrics) {
    if (!has(metric.figure) || (metric.figure == kStepError && has(kPathError))) continue;
    metrics.push_back(&metric);
  }
  return metrics;
}

std::vector<Curve> curves_of(std::span<const EvaluationRow> rows, std::string_view figure) {
  std::vector<Curve> curves;
  for (const EvaluationRow& row : rows) {
    const double value = row.figure(figure);
    if (row.codec == kOriginal || !std::isfinite(value) || !(row.coding.ratio > 0.0)) continue;
    auto curve = std::find_if(curves.begin(), curves.end(),
                              [&](const Curve& c) { return c.codec == row.codec; });
    if (curve == curves.end()) curve = curves.insert(curve, Curve{row.codec, {}});
    curve->points.push_back({row.coding.ratio, value, row.setting});
  }
  for (Curve& curve : curves) {
    std::sort(curve.points.begin(), curve.points.end(),
              [](const CurvePoint& a, const CurvePoint& b) { return a.ratio < b.ratio; });
  }
  return curves;
}

std::optional<double> best_at(const Curve& curve, double ratio, bool higher_is_better) {
  std::optional<double> best;
  const auto offer = [&](double value) {
    if (!best || is_better(value, *best, higher_is_better)) best = value;
  };
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const CurvePoint& point = curve.points[i];
    if (point.ratio < ratio) continue;
    offer(point.value);
    if (i == 0 || curve.points[i - 1].ratio >= ratio) continue;
    const CurvePoint& before = curve.points[i - 1];
    const double share = std::log(ratio / before.ratio) / std::log(point.ratio / before.ratio);
    offer(before.value + share * (point.value - before.value));
  }
  return best;
}

bool Standing::is_ahead() const {
  const double lead = metric->higher_is_better ? ours - theirs : theirs - ours;
  return rival.empty() || lead > -0.5 * std::pow(10.0, -metric->digits);
}

std::vector<Standing> standings_of(std::span<const EvaluationRow> rows) {
  std::vector<Standing> standings;
  for (const Metric* metric : metrics_of(rows)) {
    const std::vector<Curve> curves = curves_of(rows, metric->figure);
    for (const double ratio : kRatios) {
      Standing standing{metric, ratio, 0.0, {}, 0.0};
      bool has_ours = false;
      for (const Curve& curve : curves) {
        const auto value = best_at(curve, ratio, metric->higher_is_better);
        if (!value) continue;
        if (curve.codec == "beam") {
          standing.ours = *value;
          has_ours = true;
        } else if (curve.codec == "beam-fill") {
          continue;  // the same frames
        } else if (standing.rival.empty() ||
                   is_better(*value, standing.theirs, metric->higher_is_better)) {
          standing.rival = curve.codec;
          standing.theirs = *value;
        }
      }
      if (has_ours) standings.push_back(std::move(standing));
    }
  }
  return standings;
}

}  // namespace sweepcast::lab
