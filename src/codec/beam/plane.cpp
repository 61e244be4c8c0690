#include "codec/beam/plane.hpp"

namespace sweepcast::beam {

void Plane::reset(int rows, int cols, int row_margin) {
  rows_ = rows;
  cols_ = cols;
  row_margin_ = row_margin;
  pitch_ = cols + 2 * kMargin;
  const auto cells =
      static_cast<std::size_t>(pitch_) * static_cast<std::size_t>(rows + 2 * row_margin);
  range.assign(cells, 0);
  activity.assign(cells, kUnknownActivity);
  state.assign(cells, CellState::unknown);
}

void interleave(const Plane& even, const Plane& odd, Plane& out) {
  out.reset(even.rows(), even.cols() + odd.cols(), 2);
  const auto merge = [&](const auto& from_even, const auto& from_odd, auto& to, int row) {
    const auto* a = from_even.data() + even.at(row, 0);
    const auto* b = from_odd.data() + odd.at(row, 0);
    auto* c = to.data() + out.at(row, 0);
    const std::ptrdiff_t pairs = odd.cols();
    for (std::ptrdiff_t i = 0; i < pairs; ++i) {
      c[2 * i] = a[i];
      c[2 * i + 1] = b[i];
    }
    if (even.cols() > odd.cols()) c[2 * pairs] = a[pairs];
  };
  for (int row = 0; row < even.rows(); ++row) {
    merge(even.range, odd.range, out.range, row);
    merge(even.activity, odd.activity, out.activity, row);
    merge(even.state, odd.state, out.state, row);
  }
}

}  // namespace sweepcast::beam
