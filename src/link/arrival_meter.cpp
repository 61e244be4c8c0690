#include "link/arrival_meter.hpp"

#include <algorithm>
#include <cstdlib>

namespace sweepcast::link {

Microseconds ArrivalMeter::least() const {
  return std::min(least_now_, least_before_);
}

void ArrivalMeter::add(std::uint64_t counter, std::uint32_t sent_us, std::size_t bytes,
                       Microseconds now) {
  if (last_ && counter <= last_->counter) return;
  const std::uint32_t raw = static_cast<std::uint32_t>(now) - sent_us;
  const Microseconds delay = wrapped_difference(raw, reference_us_);
  const bool jumped = last_ && (now < last_->arrived || std::abs(delay - least()) > kJump);
  if (!last_ || jumped) {
    reference_us_ = raw;
    least_now_ = least_before_ = 0;
    span_began_ = now;
    last_ = {counter, sent_us, now};
    return;
  }
  if (now - span_began_ > kSpan) {
    least_before_ = least_now_;
    least_now_ = delay;
    span_began_ = now;
  }
  least_now_ = std::min(least_now_, delay);
  const bool is_of_train = wrapped_difference(sent_us, last_->sent_us) <= kTrain;
  const Microseconds unhindered = now - (delay - least());
  if (is_of_train) {
    busy_us_ += static_cast<std::uint64_t>(now - last_->arrived);
    bytes_ += bytes;
  } else if (delay - least() > kTrain) {
    busy_us_ += static_cast<std::uint64_t>(now - std::max(last_->arrived, unhindered));
  }
  last_ = {counter, sent_us, now};
}

}  // namespace sweepcast::link
