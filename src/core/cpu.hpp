// What the processor at hand can do. Code that asks has a plain twin that gives the same results.
#pragma once

namespace sweepcast {

/// Whether functions with [[gnu::target("avx2")]] may be called.
[[nodiscard]] inline bool has_avx2() noexcept {
#if defined(__x86_64__)
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
#else
  return false;
#endif
}

}  // namespace sweepcast
