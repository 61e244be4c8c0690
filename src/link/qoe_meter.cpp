#include "link/qoe_meter.hpp"

namespace sweepcast::link {

void QoeMeter::add(std::optional<std::size_t> level, std::size_t queued, bool left_whole) {
  if (!level) {
    sweeps_.clear();
    return;
  }
  if (sweeps_.size() == kSweeps) sweeps_.erase(sweeps_.begin());
  sweeps_.push_back({left_whole ? level_quality(*level) : 0.0, queued});
}

std::optional<double> QoeMeter::mean() const {
  if (sweeps_.empty()) return std::nullopt;
  return qoe(sweeps_) / static_cast<double>(sweeps_.size());
}

}  // namespace sweepcast::link
