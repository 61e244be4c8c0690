#include "rate/qoe.hpp"

#include <cmath>

namespace sweepcast {

double qoe(std::span<const QoeSweep> sweeps) {
  double sum = 0.0;
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    sum += sweeps[i].quality - kQueueWeight * static_cast<double>(sweeps[i].queued);
    if (i > 0) sum -= std::abs(sweeps[i].quality - sweeps[i - 1].quality);
  }
  return sum;
}

}  // namespace sweepcast
