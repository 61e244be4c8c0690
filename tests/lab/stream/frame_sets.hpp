// Made-up frames, so that streams can be reckoned by hand.
#pragma once

#include <cstddef>
#include <vector>

#include "lab/stream/frames.hpp"
#include "rate/qoe.hpp"

namespace sweepcast::lab {

/// One sweep with these sizes of whole frames at the levels of the ladder; F-scores 90, 80, ...
inline FrameSet ladder_of(const std::vector<std::size_t>& bytes) {
  FrameSet frames;
  frames.codec = CodecId::rcpcc;
  frames.ladder = bytes.size();
  frames.target_bytes.assign(bytes.size(), 0);
  frames.sizes.resize(1);
  for (std::size_t level = 0; level < bytes.size(); ++level) {
    frames.sizes[0].push_back({{bytes[level]}, 0});
    const double f10 = 90.0 - 10.0 * static_cast<double>(level);
    frames.qualities[{0, level, 1}] = {f10, f10 / 2.0};
  }
  return frames;
}

}  // namespace sweepcast::lab
