// How far a decoded cloud is from the original, in the figures that the field uses.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string_view>

#include "sweepcast/cloud.hpp"

namespace sweepcast::lab {

/// Peak of the PSNR, metres: the value that MPEG's common test conditions set for LiDAR sweeps.
inline constexpr double kPeakM = 59.70;

/// Distances of the F-score, metres.
inline constexpr std::array<double, 4> kFScoreDistancesM{0.02, 0.05, 0.10, 0.20};

/// Neighbours, the point itself among them, that a normal is estimated from.
inline constexpr std::size_t kNormalNeighbours = 12;

/// Symmetric nearest-neighbour figures of two clouds. "o2d" looks from every original point for the
/// nearest decoded one, "d2o" the other way. Points with a coordinate that is not finite and points
/// at the origin (a sensor's mark for "no return") are left out and counted.
///
/// Without points on one side there is no distance: the lengths, angles and PSNRs are NaN, the
/// F-scores 0. Two clouds without points are equal. Equal clouds have an infinite PSNR.
/// The counts are doubles so that the mean of many sweeps is of this type too.
struct Distortion {
  double points_original = 0;    ///< all points, those left out among them
  double points_decoded = 0;     ///< the same of the decoded cloud
  double left_out_original = 0;  ///< not finite, or at the origin
  double left_out_decoded = 0;
  double mean_o2d = 0, rms_o2d = 0, max_o2d = 0;  ///< metres
  double mean_d2o = 0, rms_d2o = 0, max_d2o = 0;  ///< metres
  double d1_psnr = 0;  ///< point to point, dB: 10 log10(3 peak^2 / worse of both mean squares)
  double d2_psnr = 0;  ///< the same of errors projected on the original's normal
  double mean_azimuth_error_deg = 0;    ///< decoded less nearest original, counter-clockwise
  double mean_elevation_error_deg = 0;  ///< the same, upward
  /// Per cent: harmonic mean of the share of decoded points within the distance of an original one
  /// and of the share of original points within it of a decoded one; in the order of
  /// `kFScoreDistancesM`.
  std::array<double, kFScoreDistancesM.size()> f_score{};
};

/// A figure of `Distortion` by its stable name; for tables, CSV and JSON.
struct DistortionFigure {
  std::string_view name;
  double Distortion::*value;
  bool is_count = false;  ///< points; whole in a single comparison
};

/// Every figure but the F-score, in the order of reports.
inline constexpr std::array<DistortionFigure, 14> kDistortionFigures{{
    {"points_original", &Distortion::points_original, true},
    {"points_decoded", &Distortion::points_decoded, true},
    {"left_out_original", &Distortion::left_out_original, true},
    {"left_out_decoded", &Distortion::left_out_decoded, true},
    {"mean_o2d", &Distortion::mean_o2d},
    {"rms_o2d", &Distortion::rms_o2d},
    {"max_o2d", &Distortion::max_o2d},
    {"mean_d2o", &Distortion::mean_d2o},
    {"rms_d2o", &Distortion::rms_d2o},
    {"max_d2o", &Distortion::max_d2o},
    {"d1_psnr", &Distortion::d1_psnr},
    {"d2_psnr", &Distortion::d2_psnr},
    {"mean_azimuth_error_deg", &Distortion::mean_azimuth_error_deg},
    {"mean_elevation_error_deg", &Distortion::mean_elevation_error_deg},
}};

/// Names of the F-scores, as in "0.05", beside `kFScoreDistancesM`.
inline constexpr std::array<std::string_view, kFScoreDistancesM.size()> kFScoreNames{
    "0.02", "0.05", "0.10", "0.20"};

/// An original prepared once (search tree, normals) and compared with any number of decoded clouds.
/// `compare` may run in several threads at a time.
class Reference {
 public:
  explicit Reference(const CloudView& original);
  Reference(Reference&&) noexcept;
  Reference& operator=(Reference&&) noexcept;
  ~Reference();

  [[nodiscard]] Distortion compare(const CloudView& decoded) const;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

/// Compares one pair of clouds.
[[nodiscard]] Distortion compare(const CloudView& original, const CloudView& decoded);

/// Sums up the mean of several sweeps, figure by figure; what is NaN or infinite in one is so in
/// the mean.
class DistortionMean {
 public:
  void add(const Distortion& distortion);
  [[nodiscard]] Distortion mean() const;  ///< zeros where nothing was added

 private:
  Distortion sum_;
  std::size_t count_ = 0;
};

}  // namespace sweepcast::lab
