// By how much a prediction is off, judged by how predictions around it were off: an adaptive
// filter, in integers.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "codec/beam/prediction.hpp"

namespace sweepcast::beam {

/// One cell of a run, its neighbours, and what is predicted for it.
struct CellView {
  const Neighbours& neighbours;
  const PredictionScale& scale;
  const Predictions& predictions;
  std::size_t i;             ///< of the cell, in the run
  const std::int32_t* self;  ///< its own range, those of the run's cells before it just before
  bool sequential;           ///< whether neighbours may be cells before it in the run
  std::uint32_t step;        ///< number of the step in the lattice
  std::uint32_t row;

  /// A neighbour's range, or that of the same neighbour of the cell `beyond` cells further on.
  [[nodiscard]] std::int32_t at(Neighbours::Place place, std::ptrdiff_t beyond = 0) const {
    return neighbours.range[place][static_cast<std::ptrdiff_t>(i) + beyond];
  }
  /// The cell before in the run, which lies between aa and a; 0 where that is not so.
  [[nodiscard]] std::int32_t before() const { return sequential || i == 0 ? 0 : self[-1]; }
  /// The cells beside n, on the side of a for -1, of b for 1, which lie beyond na and nb.
  [[nodiscard]] std::int32_t beside_n(std::ptrdiff_t side) const {
    return sequential ? 0 : at(Neighbours::n, side);
  }
};

/// Estimates offsets by a normalised least-mean-squares filter over differences around the cell,
/// with weights of its own for each step of the lattice.
class OffsetEstimator {
 public:
  static constexpr std::size_t kSigns = 9;
  using Signs = std::array<std::int32_t, kSigns>;  ///< differences, 1/16 of a step, within +-96

  void reset() {
    for (Signs& weights : weights_) weights.fill(0);
  }

  /// The offset, 1/16 of a step, within +-128.
  [[nodiscard]] std::int32_t estimate(const CellView& cell) {
    read(cell);
    const std::int32_t basis = cell.predictions.basis[cell.i];
    const std::size_t kind = basis == 0 ? 0 : basis == static_cast<int>(Basis::side) ? 1 : 2;
    now_ = &weights_[std::size_t{cell.step} * 3 + kind];
    std::int32_t sum = 0;
    for (std::size_t k = 0; k < kSigns; ++k) sum += signs_[k] * (*now_)[k];
    return std::clamp(sum >> 16, -128, 128);
  }

  /// Learns how far the estimate was off, 1/16 of a step.
  void learn(std::int32_t error) {
    std::int32_t power = kPower;
    for (const std::int32_t sign : signs_) power += sign * sign;
    const std::int32_t gain = std::clamp(error, -kMostError, kMostError) * kRate / power;
    for (std::size_t k = 0; k < kSigns; ++k) {
      std::int32_t& weight = (*now_)[k];
      weight = std::clamp(weight + ((signs_[k] * gain) >> 6), -kMostWeight, kMostWeight);
    }
  }

  [[nodiscard]] const Signs& signs() const { return signs_; }

 private:
  static constexpr std::int32_t kPower = 2'000;
  static constexpr std::int32_t kRate = 64'000;  // 1/65536 of a weight, times 64
  static constexpr std::int32_t kMostError = 48;
  static constexpr std::int32_t kMostWeight = 1 << 18;
  static constexpr std::int32_t kReach = 6;  // steps; differences beyond count as that

  // What interpolation misses beside the cell, and what other ways to predict say.
  void read(const CellView& cell) {
    using N = Neighbours;
    const std::int32_t a = cell.at(N::a);
    const std::int32_t b = cell.at(N::b);
    const std::int32_t n = cell.at(N::n);
    const std::int32_t na = cell.at(N::na);
    const std::int32_t nb = cell.at(N::nb);
    const std::int32_t sa = cell.at(N::sa);
    const std::int32_t sb = cell.at(N::sb);
    const std::int32_t aa = cell.at(N::aa);
    const std::int32_t bb = cell.at(N::bb);
    const std::int32_t nn = cell.at(N::nn);
    const std::int32_t before = cell.before();
    const std::int32_t left = cell.beside_n(-1);
    const std::int32_t right = cell.beside_n(1);
    const std::int32_t predicted = cell.predictions.range[cell.i];
    const std::int32_t carried = cell.predictions.carried[cell.i];
    const std::int32_t edge = cell.scale.edge;
    const auto joined = [edge](std::int32_t u, std::int32_t v) {
      return u > 0 && v > 0 && std::abs(u - v) < edge;
    };
    const auto bend = [](std::int32_t u, std::int32_t v, std::int32_t w) {
      return v - (u + w) / 2;
    };
    const std::int32_t reach = kReach * cell.scale.step;
    const std::int64_t sixteenths = (std::int64_t{16} << 20) / cell.scale.step;
    const auto put = [&](std::size_t k, bool is_known, std::int32_t difference) {
      const std::int64_t clipped = std::clamp(difference, -reach, reach);
      signs_[k] = is_known ? static_cast<std::int32_t>((clipped * sixteenths) >> 20) : 0;
    };
    const std::int32_t line =
        nb + static_cast<std::int32_t>(((na - nb) * std::int64_t{cell.neighbours.weight}) >> 8);
    put(0, joined(na, nb) && joined(n, na), n - line);
    put(1, joined(aa, a) && joined(before, a), bend(aa, before, a));
    put(2, joined(carried, predicted), carried - predicted);
    put(3, joined(cell.at(N::na, -1), na) && joined(left, na), bend(cell.at(N::na, -1), left, na));
    put(4, joined(cell.at(N::nb, 1), nb) && joined(right, nb), bend(nb, right, cell.at(N::nb, 1)));
    put(5, joined(aa, a) && joined(a, b) && joined(b, bb), a + b - aa - bb);
    put(6, joined(before, a) && joined(a, b), 2 * a - before - predicted);
    put(7, joined(n, nn) && joined(n, predicted), 2 * n - nn - predicted);
    put(8, joined(na, a) && joined(sa, a) && joined(nb, b) && joined(sb, b),
        -bend(na, a, sa) - bend(nb, b, sb));
  }

  std::array<Signs, 64> weights_{};  ///< 1/65536; of a step three sets
  Signs signs_{};
  Signs* now_ = &weights_[0];
};

}  // namespace sweepcast::beam
