// The last few values of something, and what strategies ask of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>

namespace sweepcast {

class Recent {
 public:
  explicit Recent(std::size_t most) : most_(most) {}

  void add(double value) {
    values_.push_back(value);
    if (values_.size() > most_) values_.pop_front();
  }

  [[nodiscard]] bool empty() const { return values_.empty(); }

  // 0 where there is none.
  [[nodiscard]] double mean() const {
    double sum = 0.0;
    for (const double value : values_) sum += value;
    return empty() ? 0.0 : sum / static_cast<double>(values_.size());
  }
  /// Of values above 0.
  [[nodiscard]] double harmonic_mean() const {
    double sum = 0.0;
    for (const double value : values_) sum += 1.0 / value;
    return empty() ? 0.0 : static_cast<double>(values_.size()) / sum;
  }
  [[nodiscard]] double largest() const {
    return empty() ? 0.0 : *std::max_element(values_.begin(), values_.end());
  }

 private:
  std::size_t most_;
  std::deque<double> values_;  ///< newest last
};

}  // namespace sweepcast
