// CPU time, which other work on the machine does not lengthen.
#pragma once

namespace sweepcast::app {

/// CPU time that this process has used so far, all threads together, in milliseconds.
[[nodiscard]] double cpu_time_ms();

}  // namespace sweepcast::app
