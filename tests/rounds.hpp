// How much of a random test is done.
#pragma once

namespace sweepcast::test {

/// `whole`, or a quarter of it under a sanitizer, which makes a test several times slower and looks
/// at each access alike, however many there are.
[[nodiscard]] constexpr int rounds(int whole) {
#ifdef __SANITIZE_ADDRESS__
  return (whole + 3) / 4;
#else
  return whole;
#endif
}

}  // namespace sweepcast::test
