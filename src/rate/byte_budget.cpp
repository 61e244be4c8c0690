#include "rate/byte_budget.hpp"

#include <algorithm>
#include <cmath>

#include "rate/beam_quality.hpp"

namespace sweepcast {

double ByteBudget::begin() {
  tries_ = 0;
  if (fits_) level_ = *fits_;
  fits_.reset();
  exceeds_.reset();
  return level_;
}

std::optional<double> ByteBudget::next(std::size_t bytes) {
  const auto size = static_cast<double>(std::max<std::size_t>(bytes, 1));
  ++tries_;
  if (size <= target_) {
    fits_ = level_;
    log_fits_ = std::log(size);
    if (size >= kLeast * target_ || level_ <= kFinestLevel) return std::nullopt;
  } else {
    exceeds_ = level_;
    log_exceeds_ = std::log(size);
    if (level_ >= kCoarsestLevel) return std::nullopt;
  }
  if (tries_ >= kMostTries && fits_) return std::nullopt;

  const double aim = std::log(kAim * target_);
  if (fits_ && exceeds_) {
    if (*fits_ - *exceeds_ < 1e-4) return std::nullopt;
    slope_ = std::min(-0.02, (log_fits_ - log_exceeds_) / (*fits_ - *exceeds_));
    // Well inside the interval, so that it shrinks.
    const double part = std::clamp((aim - log_exceeds_) / (log_fits_ - log_exceeds_), 0.1, 0.9);
    level_ = *exceeds_ + part * (*fits_ - *exceeds_);
  } else {
    // The slope is a guess: be bolder with each try.
    const double step = (aim - std::log(size)) / slope_;
    const double bold = step * (1.0 + 0.5 * (tries_ - 1));
    level_ = std::clamp(level_ + std::clamp(bold, -3.0, 3.0), kFinestLevel, kCoarsestLevel);
  }
  return level_;
}

}  // namespace sweepcast
