// The RCPCC paper's ablation study (section IV.C): what the surface model is worth against a plane,
// and the shape-adaptive DCT against plain ranges.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

#include "sweepcast/cloud.hpp"
#include "sweepcast/encoder.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast::lab {

/// Mean absolute errors of decoded ranges against the ranges in the cells before coding, which are
/// whole millimetres. Metres; NaN where there is no such cell.
struct RangeErrors {
  double fitted_mae_m = 0;  ///< over the cells that a surface describes
  double unfit_mae_m = 0;   ///< over the other cells with a point
  double mae_m = 0;         ///< over all cells with a point
  double fitted_share = 0;  ///< cells that a surface describes, of those with a point
  double ratio = 0;         ///< 16 bytes for each point that came in, over the bytes of the frames
};

/// Measures codec rcpcc at one setting over any number of sweeps; all their cells count alike.
class RangeErrorMeter {
 public:
  /// Errors: invalid_argument, see `Encoder::create`.
  [[nodiscard]] static Result<RangeErrorMeter> create(const RcpccOptions& options);
  RangeErrorMeter(RangeErrorMeter&&) noexcept;
  RangeErrorMeter& operator=(RangeErrorMeter&&) noexcept;
  ~RangeErrorMeter();

  /// Codes and decodes a sweep. Errors: those of the encoder.
  [[nodiscard]] Status add(const CloudView& cloud);
  [[nodiscard]] RangeErrors errors() const;

 private:
  struct State;
  explicit RangeErrorMeter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// A row of the paper's first table: the error on surfaces of either model at a threshold.
struct ModelRow {
  SurfaceModel model = SurfaceModel::surface;
  double threshold_m = 0;
  double paper_fitted_mae_cm = 0;
  RangeErrors ours{};
};

/// A row of the paper's second table: how the unfit cells are coded.
struct UnfitRow {
  UnfitCoding coding = UnfitCoding::sa_dct;
  double quantiser_step_m = 0;  ///< without meaning for `UnfitCoding::raw`
  double paper_unfit_mae_cm = 0;
  double paper_mae_cm = 0;
  double paper_ratio = 0;
  RangeErrors ours{};
};

/// Both tables; as declared, with the paper's figures and without ours.
struct Ablation {
  std::array<ModelRow, 6> models{{
      {SurfaceModel::plane, 0.1, 5.97},
      {SurfaceModel::plane, 0.3, 13.46},
      {SurfaceModel::plane, 0.5, 16.70},
      {SurfaceModel::surface, 0.1, 4.75},
      {SurfaceModel::surface, 0.3, 10.82},
      {SurfaceModel::surface, 0.5, 11.92},
  }};
  std::array<UnfitRow, 4> unfit{{
      {UnfitCoding::raw, 0.1, 0.19, 3.68, 32.40},
      {UnfitCoding::sa_dct, 0.1, 4.23, 5.29, 40.86},
      {UnfitCoding::sa_dct, 0.4, 16.71, 10.30, 47.19},
      {UnfitCoding::sa_dct, 1.0, 41.28, 20.05, 53.37},
  }};
};

struct AblationOptions {
  /// What all rows share. Its model, threshold, coding of unfit cells and quantiser step are
  /// replaced, except that the second table takes its threshold, which the paper does not tell.
  RcpccOptions base;
  std::function<void(std::string_view)> on_sweep{};  ///< called after each sweep with its name
};

/// Fills both tables. Errors: those of `read_cloud` and of the encoder, naming the file;
/// invalid_argument (no sweep, options out of range).
[[nodiscard]] Result<Ablation> ablate(std::span<const std::filesystem::path> sweeps,
                                      const AblationOptions& options);

}  // namespace sweepcast::lab
