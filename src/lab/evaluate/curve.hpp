// Figures over ratios, and which codec is ahead where.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lab/evaluate/evaluate.hpp"

namespace sweepcast::lab {

/// A figure that is plotted and compared.
struct Metric {
  std::string_view figure;  ///< its name in `EvaluationRow::figures`
  std::string_view task;
  std::string_view title;  ///< for people
  std::string_view unit;
  int digits = 1;  ///< after the point
  bool higher_is_better = true;
};

/// Those that were measured, in the report's order; odometry's error from sweep to sweep only where
/// the drive is too short for the other one.
[[nodiscard]] std::vector<const Metric*> metrics_of(std::span<const EvaluationRow> rows);

struct CurvePoint {
  double ratio = 0.0;
  double value = 0.0;
  std::string setting;
};

/// A codec's settings that have the figure, by ratio.
struct Curve {
  std::string codec;
  std::vector<CurvePoint> points;
};

/// A curve of each codec that has points, in the order of rows; the uncoded drive has none.
[[nodiscard]] std::vector<Curve> curves_of(std::span<const EvaluationRow> rows,
                                           std::string_view figure);

/// The best that a curve gives at this ratio or a larger one, between its points by the line over
/// the logarithm of ratios. None beyond its last point.
[[nodiscard]] std::optional<double> best_at(const Curve& curve, double ratio,
                                            bool higher_is_better);

/// Codec beam against all others at a ratio.
struct Standing {
  const Metric* metric = nullptr;
  double ratio = 0.0;
  double ours = 0.0;
  std::string rival;  ///< the best of the others; empty where none reaches this ratio
  double theirs = 0.0;

  /// Or as good, as far as the digits go that are shown.
  [[nodiscard]] bool is_ahead() const;
};

/// At each of `kRatios`, for each metric that was measured; ratios that beam has not reached are
/// left out.
[[nodiscard]] std::vector<Standing> standings_of(std::span<const EvaluationRow> rows);

}  // namespace sweepcast::lab
