// Predicts ranges from neighbours that are known, and sorts each prediction into contexts: how far
// it may be trusted. Works on many cells at once; integers only, so that every machine gets the
// same.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/beam/plane.hpp"

namespace sweepcast::beam {

/// The neighbours of a run of cells: for each, the range of the run's first cell's neighbour; those
/// of the next cells follow. On the axis that is halved: a before the cell and b after it, aa and
/// bb beyond these. On the other axis: n, which is done, nn beyond it, and the corners na, nb on
/// that side, sa, sb on the other. `near` is any range that is known nearby, where all else fails.
struct Neighbours {
  enum Place : std::size_t {
    a,
    b,
    n,
    na,
    nb,
    sa,
    sb,
    kActive,
    aa = kActive,
    bb,
    nn,
    near,
    kPlaces
  };
  std::array<const std::int32_t*, kPlaces> range;
  std::array<const std::uint8_t*, kActive> activity;
  std::int32_t weight = 128;  ///< of a in interpolation, 1/256; b has the rest
};

/// What a prediction stands on.
enum class Basis : std::int32_t {
  between,  ///< two sides at about the same depth
  gap,      ///< two sides with a jump in depth between them: a value between
  side,     ///< the same, but the cell belongs to one of them
  one,      ///< one side
  across,   ///< no side, but the other axis
  guess,    ///< something near, or nothing
};
inline constexpr std::int32_t kBases = 6;

/// Predictions of a run of cells, 0.1 mm.
struct Predictions {
  std::vector<std::int32_t> range;
  std::vector<std::int32_t> carried;  ///< from across, 0 where there is none
  std::vector<std::int32_t> spread;   ///< how far the candidates lie apart
  std::vector<std::int32_t> basis;    ///< as Basis; `gap` at every jump in depth

  void resize(std::size_t count);
};

/// Contexts of the predictions' errors. Each below kContextSizes.
struct Contexts {
  enum Which : std::size_t { trust, slope, sides, distance, direction, kCount };
  std::array<std::vector<std::int32_t>, kCount> of;
  std::vector<std::int32_t> mean;    ///< activity nearby, 0 to 15
  std::vector<std::int32_t> turned;  ///< 1 where the cell across is nearer than the prediction

  void resize(std::size_t count);
};

/// What predictions depend on beside neighbours.
struct PredictionScale {
  static constexpr std::size_t kLevels = 9;
  std::int32_t step = 1;                      ///< of ranges
  std::int32_t edge = 0;                      ///< a jump in depth, not a slope, 0.1 mm
  std::array<std::int32_t, kLevels> from{};   ///< differences from which a level counts
  std::array<std::int32_t, kLevels> share{};  ///< what a level adds to the share of `carried`

  PredictionScale() = default;
  explicit PredictionScale(std::int32_t step_of_ranges);
};

/// What can be left out, to measure what it is worth. Frames do not tell: those that are written
/// have it all.
struct Stages {
  bool prediction = true;  ///< else the value before, alone
  bool edges = true;       ///< else no choice of a side at a jump in depth
};

/// Predicts cells [0, count) of a run.
void predict(const Neighbours& at, const PredictionScale& scale, std::size_t count,
             Predictions& out);

/// Describes the predictions of cells [0, count) of a run. Unless `all`, only `trust` and
/// `turned` are filled.
void describe(const Neighbours& at, const PredictionScale& scale, const Predictions& predictions,
              std::size_t count, bool all, Contexts& out);

/// The same of cell `i` alone, whose neighbours may be cells just before it.
void predict_one(const Neighbours& at, const PredictionScale& scale, std::size_t i,
                 Predictions& out);
void describe_one(const Neighbours& at, const PredictionScale& scale,
                  const Predictions& predictions, std::size_t i, bool all, Contexts& out);

/// The two ways to compute the same; `predict` and `describe` take the faster one.
namespace plain {
void predict(const Neighbours& at, const PredictionScale& scale, std::size_t count,
             Predictions& out);
void describe(const Neighbours& at, const PredictionScale& scale, const Predictions& predictions,
              std::size_t count, bool all, Contexts& out);
}  // namespace plain

}  // namespace sweepcast::beam
